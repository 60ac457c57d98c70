//! The tables of section 3.5 of the paper, ours beside the paper's: `cargo bench --bench paper_tables`.

#[path = "../paper/mod.rs"]
mod paper;

use paper::{Course, Energies, Figures, Problem, Solved, energy, figures, solve};

/// Pieces along a side: 1,156 pieces and 2,380 control faces (one per edge).
const SIDE: usize = 34;

/// The best of so many runs counts.
const RUNS: usize = 3;

/// The paper's tables, as printed there (energies times 1e4).
const STAGE_2: [(&str, &str, [&str; 10]); 5] = [
    ("E_fair", "fair", ["4.9", "12.4", "10.3", "10.2", "10.1", "10.0", "9.5", "9.5", "9.3", "9.2"]),
    (
        "E_prox",
        "prox",
        ["89e3", "137", "0.34", "0.075", "0.072", "0.072", "0.071", "0.070", "0.070", "0.069"],
    ),
    ("E_geom", "geom", ["2100e3", "26e3", "37", "1.3", "1.2", "1.1", "1.1", "1.0", "1.0", "1.0"]),
    ("E_orth", "orth", ["1020e3", "16e3", "42", "1.0", "1.2", "1.2", "1.2", "1.2", "1.1", "1.1"]),
    ("E_bound", "boundary", OURS),
];
const SOFT: [(&str, &str, [&str; 10]); 6] = [
    ("E_prox", "prox", ["7.8", "1.3", "0.20", "0.15", "0.13", "0.11", "0.09", "0.08", "0.06", "0.05"]),
    ("E_fair", "fair", ["382", "31", "21", "17", "15", "13", "12", "11", "9.8", "9.1"]),
    ("E_isom", "isom", ["2060e3", "62e3", "22", "21", "9.0", "5.9", "4.4", "3.1", "2.1", "1.3"]),
    ("E_match", MATCH, ["0", "0.03", "0.006", "0.003", "0.002", "0.002", "0.002", "0.001", "0.001", "0.001"]),
    ("E_bound", "boundary", OURS),
    ("E_volume", "planarity", OURS),
];
const HARD: [(&str, &str, [&str; 10]); 3] = [
    ("E_isom", "isom", ["0.83", "8e-3", "3e-4", "2e-5", "2e-6", "7e-7", "3e-7", "2e-7", "1e-7", "7e-8"]),
    (
        "E_match",
        MATCH,
        ["9e-4", "8e-8", "7e-9", "1e-9", "1e-10", "2e-11", "6e-12", "2e-12", "8e-13", "4e-13"],
    ),
    ("E_volume", "planarity", OURS),
];

/// The paper has no such energy.
const OURS: [&str; 10] = [""; 10];

/// Not a term: hinges are shared unknowns.
const MATCH: &str = "match";

fn main() {
    println!("Energies times 1e4 at mean edge 1. Best wall times of {RUNS} runs.");
    for (name, problem) in [
        ("(a) flat sheet to dome", Problem::dome(SIDE)),
        ("(b) paraboloid to waved roof", Problem::paraboloid_to_roof(SIDE)),
    ] {
        for (weights, course) in [
            ("the paper's weights", Course::paper()),
            ("our weights", Course::ours()),
            ("our weights, until stagnation", Course::to_stagnation()),
        ] {
            let runs: Vec<Solved> = (0..RUNS).map(|_| solve(&problem, &course)).collect();
            println!("\n### {name}, {weights}\n");
            let mesh = &problem.cover.mesh;
            println!("{} pieces, {} control faces\n", mesh.pieces.len(), mesh.edges.len());
            print(&runs, &figures(&problem, &runs[0]));
        }
    }
}

fn print(runs: &[Solved], figures: &Figures) {
    let [second, soft, hard] = &runs[0].stages;
    table("Stage 2", 0, &second.0, &STAGE_2, figures);
    table("Stage 3, soft", 0, &soft.0, &SOFT, figures);
    table("Stage 3, hard", 10, &hard.0, &HARD, figures);
    println!("| | Stage 2 | Stage 3 soft | Stage 3 hard |\n| :-- | --: | --: | --: |");
    let best = |i: usize| runs.iter().map(|run| run.stages[i].1).fold(f64::INFINITY, f64::min);
    println!("| seconds, ours | {:.3} | {:.3} | {:.3} |", best(0), best(1), best(2));
    println!("| seconds, paper | 1.1 | 5.5 | 1.7 |");
    println!("| stopped by | {} | {} | {} |\n", second.2, soft.2, hard.2);
    println!("| at the end, from the pieces' vertices | |\n| :-- | --: |");
    let Figures { mean_edge, e_isom, e_match, coverage, closed_distance, volume, planarity } = figures;
    for (what, value) in [
        ("mean edge (asked: 1)", format!("{mean_edge:.4}")),
        ("1e4 E_isom", format!("{:.1e}", 1e4 * e_isom)),
        ("1e4 E_match", format!("{}", 1e4 * e_match)),
        ("open pattern to target, edges", format!("{:.4}", coverage[0])),
        ("target to open pattern, edges", format!("{:.4}", coverage[1])),
        ("closed pattern to its target, edges", format!("{closed_distance:.4}")),
        ("signed volume, open minus closed, cubic edges", format!("{volume:.1e}")),
        ("bend of a closed / open piece, edges", format!("{:.1e} / {:.1e}", planarity[0], planarity[1])),
    ] {
        println!("| {what} | {value} |");
    }
}

/// One table: for each energy ours, with the end, and the paper's.
fn table(
    title: &str,
    first: usize,
    energies: &Energies,
    rows: &[(&str, &str, [&str; 10])],
    figures: &Figures,
) {
    let numbers: Vec<String> = (first..=first + 10).map(|i| i.to_string()).collect();
    println!("| {title} | {} |\n| :-- |{}", numbers.join(" | "), " --: |".repeat(11));
    for (name, term, paper) in rows {
        let cell = |i: usize| match energies.get(i) {
            None => "-".to_owned(),
            Some(_) if *term == MATCH => figure(figures.e_match),
            Some(row) => figure(1e4 * energy(row, term)),
        };
        let ours: Vec<String> = (0..=10).map(cell).collect();
        println!("| {name} | {} |", ours.join(" | "));
        if *paper != OURS {
            println!("| paper | {} | |", paper.join(" | "));
        }
    }
    println!();
}

/// Two digits, as the paper has them.
fn figure(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        v if (0.01..1.0).contains(&v) => format!("{v:.3}"),
        v if (1.0..1000.0).contains(&v) => format!("{v:.1}"),
        v => format!("{v:.1e}"),
    }
}
