//! The `kirimorph` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    kirimorph::cli::run(std::env::args_os())
}
