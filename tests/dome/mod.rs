//! A real design to test with: a shallow dome of 6 x 6 pieces, made by the optimiser's own stages.

// Each test file uses its own part.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::path::Path;

use kirimorph::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use kirimorph::fabrication::hinge_table::HingeRow;
use kirimorph::geometry::mesh::TriMesh;
use kirimorph::geometry::{Point3, Vector2};
use kirimorph::kirigami::design::Design;
use kirimorph::kirigami::pattern::Pattern;
use kirimorph::kirigami::quality::Quality;
use kirimorph::output::design_json::{self, DesignFile, Provenance, Stage, WriteDesignError};
use kirimorph::output::hinge_report;
use kirimorph::profile::{self, Profile};

use super::solve::solve;

/// A design with its measures and the solver's reports.
pub struct Made {
    pub design: Design,
    pub quality: Quality,
    pub stages: Vec<Stage>,
}

/// The design after all stages, and one whose pieces are neither rigid nor flat: what Stage 3 starts from, shaken.
pub struct Dome {
    pub made: Made,
    pub shaken: Made,
    pub profile: Profile,
}

/// Makes the dome.
pub fn dome() -> Dome {
    let profile = profile::load("steel-304-0.5mm", Path::new("")).unwrap();
    let gap = profile.hinge_gap();
    let mesh = mesh(14, 90.0, 14.0);
    let solved = solve(&mesh, [6, 6], [std::f64::consts::SQRT_2; 2], gap, |_| Vector2::x());
    let mut shaken = solved.start.clone();
    shaken.open.iter_mut().enumerate().for_each(|(i, p)| p.z += 0.3 * (i as f64).sin());
    let [second, third] = solved.reports.clone();
    let stages = vec![
        Stage { name: "stage-1", reports: vec![] },
        Stage { name: "stage-2", reports: second },
        Stage { name: "stage-3", reports: third },
    ];
    let made = |pattern: &Pattern, stages| {
        let (design, quality) = solved.measured(pattern);
        Made { design, quality, stages }
    };
    Dome { shaken: made(&shaken, vec![]), made: made(&solved.pattern, stages), profile }
}

/// The `design.json` of a design; what is refused leaves nothing.
pub fn design_text(made: &Made, max_strain: Option<f64>) -> Result<String, WriteDesignError> {
    let hashes = BTreeMap::from([("dome.obj".to_string(), "sha256:00ff".to_string())]);
    let provenance =
        Provenance { job: "jobs/of \"mine\"/dome.toml", target: "../meshes/dome.obj", hashes: &hashes };
    let file = DesignFile {
        design: &made.design,
        quality: &made.quality,
        stages: &made.stages,
        max_strain,
        provenance,
    };
    let mut bytes = Vec::new();
    design_json::write(&file, &mut bytes).inspect_err(|_| assert!(bytes.is_empty()))?;
    Ok(String::from_utf8(bytes).unwrap())
}

/// The dome laid out for its profile.
pub fn laid_out(dome: &Dome) -> Fabrication {
    let lengths = ligament_lengths(&dome.made.design, &dome.profile).unwrap();
    fabricate(&dome.made.design, &dome.profile, &lengths).unwrap()
}

/// `hinges.json` of some rows.
pub fn hinges_text(dome: &Dome, rows: &[HingeRow]) -> String {
    let mut bytes = Vec::new();
    hinge_report::write_json(rows, &dome.profile, None, None, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// A dome over a square, off the origin so that no coordinate is a round number.
fn mesh(cells: usize, span: f64, height: f64) -> TriMesh {
    let n = cells + 1;
    let vertex = |i: usize, j: usize| {
        let [u, v] = [i, j].map(|k| 2.0 * k as f64 / cells as f64 - 1.0);
        let z = height * (1.0 - 0.5 * (u * u + v * v));
        Point3::new(0.5 * span * u + 21.7, 0.5 * span * v - 3.1, z + 1.3)
    };
    let cell = |i: usize, j: usize| {
        let at = |i: usize, j: usize| j * n + i;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    TriMesh {
        vertices: (0..n * n).map(|k| vertex(k % n, k / n)).collect(),
        faces: (0..cells * cells).flat_map(|k| cell(k % cells, k / cells)).collect(),
    }
}
