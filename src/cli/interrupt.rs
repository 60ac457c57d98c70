//! Ctrl-C and the wish to end: the first one asks the work to stop at its next step, the second one ends at
//! once.

use std::io::{IsTerminal, Write, stderr};
use std::ops::ControlFlow;
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};

/// Signals come to the process, so the wish is the process's too.
static ASKED: AtomicBool = AtomicBool::new(false);

/// What shells take for "ended by Ctrl-C".
const ENDED_BY_SIGNAL: i32 = 130;

/// Takes over SIGINT, SIGTERM and SIGHUP (Ctrl-C and closing on Windows). Where the system refuses, they end
/// the program as usual.
pub fn listen() {
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            exit(ENDED_BY_SIGNAL);
        }
        if stderr().is_terminal() {
            let _ = writeln!(stderr(), "\r\x1b[Kstopping after this step; Ctrl-C again stops at once");
        }
    });
}

/// Break where a signal asked for it.
pub fn flow() -> ControlFlow<()> {
    if ASKED.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}
