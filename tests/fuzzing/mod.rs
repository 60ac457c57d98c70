//! A small mutation fuzzer on stable Rust: shared by the tests that look for panics, hangs and memory.
//!
//! Inputs are our own valid files after a few random edits, the same for the same seed and number. Environment:
//!
//! * `KIRIMORPH_FUZZ_SECONDS`: how long all targets together may take (60);
//! * `KIRIMORPH_FUZZ_SEED`: another sequence (1); a failure names its seed and the input's number;
//! * `KIRIMORPH_FUZZ_FIRST`: the number to begin with, so that one input comes again at once.

// Each test file uses its own part.
#![allow(dead_code)]

pub mod mutation;

use std::io::{Seek, SeekFrom, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

pub use mutation::{Random, mutate};
use peak_alloc::PeakAlloc;

/// No input may take longer.
pub const LONGEST: Duration = Duration::from_secs(10);

/// Memory that an input may take beside ten times its size, bytes.
const MEMORY: usize = 200 << 20;

/// Worker threads get the stack of a program's main thread.
const STACK: usize = 8 << 20;

/// Counts the memory that is taken.
#[global_allocator]
static ALLOCATED: PeakAlloc = PeakAlloc;

/// Memory is counted for the whole process: one target at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// A number of the environment.
fn setting(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name}={text}: no number")))
}

/// How long all targets together may take.
pub fn seconds() -> f64 {
    setting("KIRIMORPH_FUZZ_SECONDS").unwrap_or(60) as f64
}

/// The seed of all sequences.
pub fn seed() -> u64 {
    setting("KIRIMORPH_FUZZ_SEED").unwrap_or(1)
}

/// The number of the first input.
pub fn first() -> u64 {
    setting("KIRIMORPH_FUZZ_FIRST").unwrap_or(0)
}

/// A folder for the files of a target.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The input of this number: one of the seeds, changed.
pub fn input(seeds: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut random = Random::new(seed() ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let base = random.below(seeds.len());
    mutate(&seeds[base], seeds, &mut random)
}

/// What is wrong with how `read` takes the bytes; `None` if nothing is.
pub fn fault(bytes: &[u8], read: &(dyn Fn(&[u8]) + Sync)) -> Option<String> {
    let before = ALLOCATED.current_usage();
    ALLOCATED.reset_peak_usage();
    let begun = Instant::now();
    let panicked = catch_unwind(AssertUnwindSafe(|| read(bytes))).err();
    let (took, peak) = (begun.elapsed(), ALLOCATED.peak_usage().saturating_sub(before));
    let limit = 10 * bytes.len() + MEMORY;
    if let Some(cause) = panicked {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        return Some(format!("panicked: {}", text.or(cause.downcast_ref().copied()).unwrap_or("?")));
    }
    if took > LONGEST {
        return Some(format!("took {took:.1?}"));
    }
    (peak > limit).then(|| format!("took {peak} bytes of memory for an input of {}", bytes.len()))
}

/// The number under test and the moment it began, milliseconds after `start`, for the watch.
struct Pulse {
    number: AtomicU64,
    begun: AtomicU64,
}

/// Reads changed seeds for a `share` of the time, and panics with the first input that is taken badly: it is kept in
/// a file. `read` must take the seeds as they are.
pub fn fuzz(name: &str, share: f64, seeds: &[Vec<u8>], read: impl Fn(&[u8]) + Sync) {
    let _alone = ALONE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let folder = folder(name);
    let start = Instant::now();
    let time = Duration::from_secs_f64(seconds() * share);
    let pulse = Pulse { number: AtomicU64::new(first()), begun: AtomicU64::new(0) };
    for (index, bytes) in seeds.iter().enumerate() {
        assert_eq!(fault(bytes, &read), None, "{name}: seed {index} as it is");
    }
    let work = || {
        // What ends the process, as a full stack does, is found here.
        let mut at = std::fs::File::create(folder.join("at")).unwrap();
        for number in first().. {
            if start.elapsed() > time && number > first() {
                return Ok(number - first());
            }
            at.seek(SeekFrom::Start(0)).and_then(|_| write!(at, "{number:020}")).unwrap();
            let bytes = input(seeds, number);
            pulse.begun.store(start.elapsed().as_millis() as u64, Ordering::SeqCst);
            pulse.number.store(number, Ordering::SeqCst);
            if let Some(what) = fault(&bytes, &read) {
                return Err((number, what));
            }
        }
        unreachable!("numbers do not end");
    };
    let result = std::thread::scope(|scope| {
        let worker = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work).unwrap();
        while !worker.is_finished() {
            std::thread::sleep(Duration::from_millis(20));
            let since = start.elapsed().as_millis() as u64 - pulse.begun.load(Ordering::SeqCst);
            if since > 3 * LONGEST.as_millis() as u64 && !worker.is_finished() {
                // A thread cannot be ended: the process is.
                let number = pulse.number.load(Ordering::SeqCst);
                eprintln!("{}", told(name, &folder, seeds, number, "hangs"));
                std::process::exit(101);
            }
        }
        worker.join().unwrap()
    });
    match result {
        Ok(count) => println!("{name}: {count} inputs in {:.1} s", start.elapsed().as_secs_f64()),
        Err((number, what)) => panic!("{}", told(name, &folder, seeds, number, &what)),
    }
}

/// Keeps an input, and says how to have it again.
fn told(name: &str, folder: &Path, seeds: &[Vec<u8>], number: u64, what: &str) -> String {
    let file = folder.join(format!("{}-{number}", seed()));
    std::fs::write(&file, input(seeds, number)).unwrap();
    format!(
        "{name}: input {number} {what}; it is in {}; again with KIRIMORPH_FUZZ_SEED={} KIRIMORPH_FUZZ_FIRST={number}",
        file.display(),
        seed()
    )
}
