//! How good verification is: every sample's machine files are spoiled in many places at random, and every spoiled one must be
//! found out. A spoiled file that leaves the same sheet is no fault: that is measured here, by other means than verification's, and
//! another place is tried. `cargo test --release --test mutations -- --nocapture` prints how many of each kind were tried.

mod seeded;

use kirimorph::profile::Process;
use kirimorph::verify::Fault;
use rayon::prelude::*;
use seeded::laser::{differ, faults};
use seeded::mill::{Program, program};
use seeded::{Spoiled, laser_faults, mill_faults, samples, told, tried};

/// Places that are spoiled per kind of fault and sample.
const PLACES: u64 = 3;

#[test]
fn every_fault_in_the_laser_files_of_any_sample_is_caught() {
    let samples = samples(Process::Laser);
    assert!(samples.len() >= 10, "{}", samples.len());
    let all: Vec<(usize, usize, u64)> = (0..samples.len())
        .flat_map(|s| (0..laser_faults::FAULTS.len()).flat_map(move |f| (0..PLACES).map(move |p| (s, f, p))))
        .collect();
    // What is known of an unharmed sheet, its hinge report tells.
    let known: Vec<Vec<Fault>> =
        samples.par_iter().map(|sample| faults(sample, &sample.sheet.layout)).collect();
    assert!(known.iter().flatten().all(|fault| fault.hinge.is_some()), "{known:?}");
    let tried = all.into_par_iter().filter_map(|(s, f, place)| {
        let (sample, (fault, spoil)) = (&samples[s], laser_faults::FAULTS[f]);
        tried(format!("{}, {place}", sample.name), fault, 1000 * (100 * s + f) as u64 + place, |dice| {
            let mut layout = sample.sheet.layout.clone();
            spoil(&mut layout, sample, dice)?;
            let caught = faults(sample, &layout).iter().any(|fault| !known[s].contains(fault));
            Some(if caught {
                Spoiled::Caught
            } else {
                Spoiled::Missed(differ(&layout, &sample.sheet.layout))
            })
        })
    });
    told(&tried.collect::<Vec<_>>());
}

#[test]
fn every_fault_in_the_programs_of_any_sample_is_caught() {
    let samples = samples(Process::Milling);
    assert!(samples.len() >= 3, "{}", samples.len());
    let programs: Vec<Program> = samples.par_iter().map(program).collect();
    let all: Vec<(usize, usize)> =
        (0..programs.len()).flat_map(|p| (0..mill_faults::FAULTS.len()).map(move |f| (p, f))).collect();
    let tried = all.into_par_iter().filter_map(|(p, f)| {
        let (program, (fault, spoil)) = (&programs[p], mill_faults::FAULTS[f]);
        tried(program.sample.name.clone(), fault, f as u64, |dice| {
            let mut lines: Vec<String> = program.text().lines().map(str::to_owned).collect();
            spoil(&mut lines, dice)?;
            let text = lines.join("\n") + "\n";
            let caught = program.refuses(&text);
            Some(if caught { Spoiled::Caught } else { Spoiled::Missed(program.differs(&text)) })
        })
    });
    // That the unspoiled ones pass, `mill` itself has seen to.
    told(&tried.collect::<Vec<_>>());
}
