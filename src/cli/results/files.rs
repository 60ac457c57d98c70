//! The files, one at a time per core.

use std::fs::File;
use std::io::{BufWriter, Write};

use rayon::prelude::*;

use super::super::{milled, morphs::Moving, setup_sheet};
use super::{Results, WriteError, no_cut_file};
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::notes::applied_words;
use crate::fabrication::plan::CutPlan;
use crate::fabrication::product::{Assembly, Product};
use crate::kirigami::design::State;
use crate::machine::Machine;
use crate::output::Heading;
use crate::output::design_json::{self, Provenance};
use crate::output::exchange::{solids, write_stl};
use crate::output::folder::{MILL_FILES, MORPH, MOVED, OutputFolder, PART, REPORT, SNAP_FILES, SOLIDS};
use crate::output::preview::assembly::{self, AssemblyPreview};
use crate::output::preview::{self, Preview};
use crate::output::{dxf, glb, hinge_report, report, snap_report, svg, toolpath_svg};
use crate::pipeline::mill::Milled;
use crate::pipeline::{Timings, fingerprint};
use crate::verify;

impl Results<'_> {
    /// Of the job or the design.
    pub(in super::super) fn name(&self) -> &str {
        self.file.provenance.job
    }

    /// What its pages are called, and their figures.
    pub(super) fn heading(&self) -> Heading<'_> {
        let Provenance { job: name, target, .. } = self.file.provenance;
        Heading { name, target, profile: self.profile, figures: self.figures }
    }

    /// Writes all files but the times.
    pub(super) fn write(&self, out: &OutputFolder) -> Result<(), WriteError> {
        out.write::<WriteError>("design.json", |file| Ok(design_json::write(&self.file, file)?))?;
        let hash = fingerprint(&out.read("design.json")?);
        let mut files = self.pages();
        match (self.product, &self.extras.plan) {
            (Product::Sheet(sheet), Some(plan)) => {
                files.extend(self.machine_files(plan, &hash));
                files.extend(self.views_of_sheet(sheet));
            }
            (Product::Sheet(_), None) => {
                return Err(WriteError("a sheet without a plan for cutting".to_owned()));
            }
            (Product::Assembly(assembly), _) => files.extend(self.views_of_pieces(assembly)),
        }
        // One at a time per core; where several fail the first one is told.
        let written: Vec<Result<(), WriteError>> =
            files.par_iter().with_max_len(1).map(|(name, write)| out.write(name, write)).collect();
        written.into_iter().collect()
    }

    /// What people and programs read of the hinges and the whole.
    fn pages(&self) -> Vec<Writing<'_>> {
        let Self { product, profile, extras, .. } = self;
        let hinges = product.hinges();
        let mut files = vec![
            writing(REPORT, |file| {
                Ok(report::write(&self.report(&self.remarks(), &self.cutting(), &self.setup()), file)?)
            }),
            writing("hinges.json", |file| {
                let mill = extras.milled().map(|(milled, machine)| milled::object(milled, machine));
                let cut = extras.plan.as_ref().map(|plan| &plan.report);
                Ok(hinge_report::write_json(hinges, profile, cut, mill.as_ref(), file)?)
            }),
            writing("hinges.csv", |file| Ok(hinge_report::write_csv(hinges, file)?)),
        ];
        if let Some(snap) = &extras.snap {
            let [json, svg] = SNAP_FILES;
            let object = snap_report::object(snap, &profile.name);
            files.push(writing(json, move |file| Ok(writeln!(file, "{object:#}")?)));
            files.push(writing(svg, |file| Ok(snap_report::write_plot(snap, self.name(), file)?)));
        }
        if let Some(Moving { morph, bodies }) = &extras.moving {
            files.push(writing(MORPH, move |file| {
                let scene = glb::Scene { name: self.name(), design: product.design(), bodies, morph };
                Ok(glb::write(&scene, file)?)
            }));
        }
        files
    }

    /// The cut files or the program, with the design's hash in them.
    fn machine_files<'b>(&'b self, plan: &'b CutPlan, hash: &str) -> Vec<Writing<'b>> {
        let profile = self.profile;
        let comments = [
            format!("kirimorph {}, job {}, profile {}", env!("CARGO_PKG_VERSION"), self.name(), profile.name),
            format!("millimetres; {}", applied_words(profile)),
            verify::hash_comment(hash),
        ];
        if let Some((milled, machine)) = self.extras.milled() {
            return self.program_files(milled, machine, comments);
        }
        let again = comments.clone();
        vec![
            writing("cut.dxf", move |file| Ok(dxf::write(&plan.layout, self.dxf, &comments, file)?)),
            writing("cut.svg", move |file| Ok(svg::write(&plan.layout, &again, file)?)),
        ]
    }

    /// The program, its picture, and what the person at the machine needs to know. What was verified is what is written.
    fn program_files<'b>(
        &'b self,
        milled: &'b Milled,
        machine: &'b Machine,
        notes: [String; 3],
    ) -> Vec<Writing<'b>> {
        let [picture, setup] = MILL_FILES;
        let stock = [self.profile.sheet.width, self.profile.sheet.height];
        let program = milled
            .program
            .files
            .iter()
            .map(|(name, text)| writing(name, |file| Ok(file.write_all(text.as_bytes())?)));
        let mut files: Vec<Writing> = program.collect();
        files.push(writing(picture, move |file| {
            let drawn = toolpath_svg::Picture { planned: &milled.planned, stock, notes: &notes };
            Ok(toolpath_svg::write(&drawn, file)?)
        }));
        files.push(writing(setup, |file| {
            Ok(file.write_all(setup_sheet::setup(milled, self, machine).as_bytes())?)
        }));
        files
    }

    /// The solids of a sheet, and the page that shows it.
    fn views_of_sheet<'b>(&'b self, fabrication: &'b Fabrication) -> Vec<Writing<'b>> {
        let mut files = Vec::new();
        if let Some(solids) = &self.extras.solids {
            let moved = MOVED[usize::from(fabrication.design.sheet_state == Some(State::Open))];
            for (name, mesh) in [(PART, &solids.part), (moved, &solids.moved)] {
                files.push(writing(name, |file| Ok(write_stl(mesh.triangles(), file)?)));
            }
        }
        let milled = self.extras.milled.is_some();
        let preview = Preview {
            fabrication,
            heading: self.heading(),
            groove: if milled { "tool" } else { "kerf" },
            made_from: if milled { "the mill runs the program" } else { "cut cut.dxf or cut.svg" },
        };
        files.push(writing("preview.svg", move |file| Ok(preview::write(&preview, file)?)));
        files
    }

    /// The solids of the pieces in both states, and the page that shows them.
    fn views_of_pieces<'b>(&'b self, assembly: &'b Assembly) -> Vec<Writing<'b>> {
        let solid = |(name, state): (&'b str, State)| {
            writing(name, move |file| {
                let triangles = solids(&assembly.design, state, self.profile.sheet.thickness)
                    .map_err(|(piece, error)| WriteError(format!("piece {piece}: {error}")))?;
                Ok(write_stl(triangles.iter().copied(), file)?)
            })
        };
        let mut files: Vec<Writing> =
            SOLIDS.into_iter().zip([State::Closed, State::Open]).map(solid).collect();
        files.push(writing("preview.svg", |file| {
            let remark = &no_cut_file(&self.profile.name);
            Ok(assembly::write(&AssemblyPreview { assembly, heading: self.heading(), remark }, file)?)
        }));
        files
    }
}

/// A file's name, and what writes it.
type Writing<'a> = (&'a str, Box<dyn Fn(&mut BufWriter<File>) -> Result<(), WriteError> + Send + Sync + 'a>);

fn writing<'a>(
    name: &'a str,
    write: impl Fn(&mut BufWriter<File>) -> Result<(), WriteError> + Send + Sync + 'a,
) -> Writing<'a> {
    (name, Box::new(write))
}

/// Writes `timings.json`.
pub(super) fn write_timings(timings: &Timings, out: &mut BufWriter<File>) -> Result<(), WriteError> {
    let stages: Vec<_> = timings
        .0
        .iter()
        .map(|(name, seconds)| serde_json::json!({ "name": name, "seconds": seconds }))
        .collect();
    serde_json::to_writer_pretty(&mut *out, &serde_json::json!({ "stages": stages }))?;
    Ok(writeln!(out)?)
}
