//! How much memory a pattern takes, and how much there is: so that a job that cannot end is refused before it
//! starts.

use std::fs;
use std::path::Path;

use crate::kirigami::design::PatternKind;
use crate::kirigami::stage3::Regime;
use crate::solver::Coupling;

/// Bytes that the program takes beside the pattern: code, target, input and output.
const BYTES_OF_PROGRAM: f64 = 12e6;

/// What a piece (a cell, where the pattern is bistable) takes: mesh, terms, normal equations, and its share of the factors.
struct PerPiece {
    /// Bytes that do not grow with the pattern.
    always: f64,
    /// Bytes per doubling of the number of pieces: the factor of a planar grid grows as n log n.
    per_doubling: f64,
}

/// Constants that stay a little above the peak of the resident memory of `kirimorph design`, which
/// `estimates_cover_what_was_measured` lists.
impl PerPiece {
    const FULLY_COUPLED: Self = Self { always: 43_000.0, per_doubling: 2_300.0 };
    const COUPLED_BY_PLACE: Self = Self { always: 27_000.0, per_doubling: 950.0 };
    const BISTABLE: Self = Self { always: 116_000.0, per_doubling: 4_600.0 };
}

/// The optimisation needs more memory than there is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the optimisation of {pieces} {} needs about {:.1} GiB of memory, {:.1} GiB are free: ask for at most {most}, or try it \
     with --ignore-memory",
    if *kind == PatternKind::Bistable { "cells" } else { "pieces" },
    gibibytes(*needed), gibibytes(*free)
)]
pub struct NotEnough {
    /// What they are pieces of.
    pub kind: PatternKind,
    /// Number of pieces, or of bistable cells.
    pub pieces: usize,
    /// Bytes that they need.
    pub needed: u64,
    /// Bytes that there are.
    pub free: u64,
    /// Most pieces that these suffice for.
    pub most: usize,
}

fn gibibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}

/// Bytes that the optimisation of a pattern with so many pieces, or bistable cells, takes, about, where it begins with fewer, larger pieces. If these
/// lead nowhere the pattern is begun anew, fully coupled, which takes twice as much.
pub fn estimate(kind: PatternKind, pieces: usize) -> u64 {
    let n = pieces as f64;
    let PerPiece { always, per_doubling } = match (kind, Regime::from_coarser(pieces).coupling) {
        (PatternKind::Bistable, _) => PerPiece::BISTABLE,
        (_, Coupling::Full) => PerPiece::FULLY_COUPLED,
        (_, Coupling::ByPlace) => PerPiece::COUPLED_BY_PLACE,
    };
    (BYTES_OF_PROGRAM + n * (always + per_doubling * n.max(1.0).log2())) as u64
}

/// Checks that a pattern fits into `free` bytes.
///
/// # Errors
/// [`NotEnough`], with the number of pieces that would fit.
pub fn check(kind: PatternKind, pieces: usize, free: u64) -> Result<(), NotEnough> {
    let needed = estimate(kind, pieces);
    if needed <= free {
        return Ok(());
    }
    let (mut most, mut too_many) = (0, pieces);
    while too_many - most > 1 {
        let middle = most + (too_many - most) / 2;
        if estimate(kind, middle) <= free { most = middle } else { too_many = middle }
    }
    Err(NotEnough { kind, pieces, needed, free, most })
}

/// Bytes that a process may take now: what Linux calls available, and no more than the limits of its control
/// groups leave. `None` where the system does not say.
pub fn free() -> Option<u64> {
    let machine = available(&fs::read_to_string("/proc/meminfo").ok()?)?;
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    Some(group_left(&groups, Path::new("/sys/fs/cgroup")).map_or(machine, |left| left.min(machine)))
}

/// `MemAvailable` of /proc/meminfo, in bytes.
fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// Least that the memory limits of a version 2 control group and of those above leave. Cached files that the
/// kernel gives back on demand do not count as taken.
fn group_left(groups: &str, root: &Path) -> Option<u64> {
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let left = |folder: &Path| -> Option<u64> {
        let number = |name: &str| fs::read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
        // No limit is written "max".
        let (limit, taken) = (number("memory.max")?, number("memory.current")?);
        let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
        let cached = stat.lines().find_map(|line| line.strip_prefix("inactive_file ")?.parse::<u64>().ok());
        Some(limit.saturating_sub(taken.saturating_sub(cached.unwrap_or(0))))
    };
    let own = root.join(group);
    own.ancestors().take_while(|folder| folder.starts_with(root)).filter_map(left).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROTATING: PatternKind = PatternKind::RotatingRectangles;

    #[test]
    fn estimates_cover_what_was_measured() {
        // Pieces and peak resident MiB of whole runs on the sample dome; bistable cells on one of a fifth of its span.
        let measured = [
            (576, 42.7),
            (1_156, 78.2),
            (2_304, 150.2),
            (4_096, 273.9),
            (4_900, 323.4),
            (5_184, 189.6),
            (10_000, 365.1),
            (22_500, 833.6),
            (48_400, 1806.6),
            (99_856, 3848.7),
        ];
        for (pieces, peak) in measured {
            let ratio = estimate(ROTATING, pieces) as f64 / (peak * 1024.0 * 1024.0);
            assert!((1.01..1.15).contains(&ratio), "{pieces}: {ratio}");
        }
        for (cells, peak) in [(1024, 155.5), (10_000, 1560.4)] {
            let ratio = estimate(PatternKind::Bistable, cells) as f64 / (peak * 1024.0 * 1024.0);
            assert!((1.01..1.15).contains(&ratio), "{cells}: {ratio}");
        }
    }

    #[test]
    fn refuses_what_does_not_fit_and_says_what_does() {
        assert_eq!(check(ROTATING, 1000, estimate(ROTATING, 1000)), Ok(()));
        let refused = check(ROTATING, 1_000_000, 20 << 30).unwrap_err();
        assert!(
            estimate(ROTATING, refused.most) <= 20 << 30 && estimate(ROTATING, refused.most + 1) > 20 << 30
        );
        let text = refused.to_string();
        assert!(text.contains("1000000 pieces needs about ") && text.contains("20.0 GiB are free"), "{text}");
        assert_eq!(check(ROTATING, 10, 0).unwrap_err().most, 0);
        // A million pieces are refused on a machine of 24 GiB, and half of them are not.
        assert!(check(ROTATING, 1_000_000, 24 << 30).is_err() && check(ROTATING, 500_000, 24 << 30).is_ok());
    }

    #[test]
    fn reads_what_linux_says() {
        let meminfo = "MemTotal:       24000000 kB\nMemFree: 1 kB\nMemAvailable:   23000000 kB\n";
        assert_eq!(available(meminfo), Some(23_000_000 * 1024));
        assert_eq!(available("MemFree: 1 kB\n"), None);
        let root = std::env::temp_dir().join(format!("kirimorph-memory-{}", std::process::id()));
        let write = |folder: &str, name: &str, text: &str| {
            fs::create_dir_all(root.join(folder)).unwrap();
            fs::write(root.join(folder).join(name), text).unwrap();
        };
        write("a/b", "memory.max", "max\n");
        write("a", "memory.max", "5000\n");
        write("a", "memory.current", "3000\n");
        write("a", "memory.stat", "anon 2\ninactive_file 1000\n");
        assert_eq!(group_left("0::/a/b\n", &root), Some(3000));
        write("a/b", "memory.max", "700\n");
        write("a/b", "memory.current", "900\n");
        assert_eq!(group_left("1:cpu:/x\n0::/a/b\n", &root), Some(0));
        assert_eq!(group_left("0::/c\n", &root), None);
        fs::remove_dir_all(root).unwrap();
    }
}
