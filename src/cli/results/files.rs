//! The files, one after the other.

use std::fs::File;
use std::io::{BufWriter, Write};

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
        let Self { product, profile, .. } = self;
        let hinges = product.hinges();
        out.write::<WriteError>("design.json", |file| Ok(design_json::write(&self.file, file)?))?;
        out.write::<WriteError>("hinges.json", |file| {
            let mill = self.extras.milled().map(|(milled, machine)| milled::object(milled, machine));
            let cut = self.extras.plan.as_ref().map(|plan| &plan.report);
            Ok(hinge_report::write_json(hinges, profile, cut, mill.as_ref(), file)?)
        })?;
        out.write::<WriteError>("hinges.csv", |file| Ok(hinge_report::write_csv(hinges, file)?))?;
        if let Some(snap) = &self.extras.snap {
            let [json, svg] = SNAP_FILES;
            let object = snap_report::object(snap, &profile.name);
            out.write::<WriteError>(json, |file| Ok(writeln!(file, "{object:#}")?))?;
            out.write::<WriteError>(svg, |file| Ok(snap_report::write_plot(snap, self.name(), file)?))?;
        }
        if let Some(Moving { morph, bodies }) = &self.extras.moving {
            let scene = glb::Scene { name: self.name(), design: product.design(), bodies, morph };
            out.write::<WriteError>(MORPH, |file| Ok(glb::write(&scene, file)?))?;
        }
        out.write::<WriteError>(REPORT, |file| {
            Ok(report::write(&self.report(&self.remarks(), &self.cutting(), &self.setup()), file)?)
        })?;
        match (product, &self.extras.plan) {
            (Product::Sheet(sheet), Some(plan)) => self.write_sheet(sheet, plan, out),
            (Product::Sheet(_), None) => Err(WriteError("a sheet without a plan for cutting".to_owned())),
            (Product::Assembly(assembly), _) => self.write_assembly(assembly, out),
        }
    }

    /// The cut files and the page that shows them.
    fn write_sheet(
        &self,
        fabrication: &Fabrication,
        plan: &CutPlan,
        out: &OutputFolder,
    ) -> Result<(), WriteError> {
        let profile = self.profile;
        let comments = [
            format!("kirimorph {}, job {}, profile {}", env!("CARGO_PKG_VERSION"), self.name(), profile.name),
            format!("millimetres; {}", applied_words(profile)),
            verify::hash_comment(&fingerprint(&out.read("design.json")?)),
        ];
        if let Some((milled, machine)) = self.extras.milled() {
            self.write_program(milled, machine, &comments, out)?;
        } else {
            out.write::<WriteError>("cut.dxf", |file| {
                Ok(dxf::write(&plan.layout, self.dxf, &comments, file)?)
            })?;
            out.write::<WriteError>("cut.svg", |file| Ok(svg::write(&plan.layout, &comments, file)?))?;
        }
        if let Some(solids) = &self.extras.solids {
            let moved = MOVED[usize::from(fabrication.design.sheet_state == Some(State::Open))];
            for (name, mesh) in [(PART, &solids.part), (moved, &solids.moved)] {
                out.write::<WriteError>(name, |file| Ok(write_stl(mesh.triangles(), file)?))?;
            }
        }
        let preview = Preview {
            fabrication,
            heading: self.heading(),
            groove: if self.extras.milled.is_some() { "tool" } else { "kerf" },
            made_from: match self.extras.milled {
                Some(_) => "the mill runs the program",
                None => "cut cut.dxf or cut.svg",
            },
        };
        out.write::<WriteError>("preview.svg", |file| Ok(preview::write(&preview, file)?))
    }

    /// The program, its picture, and what the person at the machine needs to know. What was verified is what is written.
    fn write_program(
        &self,
        milled: &Milled,
        machine: &Machine,
        comments: &[String],
        out: &OutputFolder,
    ) -> Result<(), WriteError> {
        for (name, text) in &milled.program.files {
            out.write::<WriteError>(name, |file| Ok(file.write_all(text.as_bytes())?))?;
        }
        let [picture, setup] = MILL_FILES;
        let stock = [self.profile.sheet.width, self.profile.sheet.height];
        let drawn = toolpath_svg::Picture { planned: &milled.planned, stock, notes: comments };
        out.write::<WriteError>(picture, |file| Ok(toolpath_svg::write(&drawn, file)?))?;
        let text = setup_sheet::setup(milled, self, machine);
        out.write::<WriteError>(setup, |file| Ok(file.write_all(text.as_bytes())?))
    }

    /// The solids of the pieces in both states, and the page that shows them.
    fn write_assembly(&self, assembly: &Assembly, out: &OutputFolder) -> Result<(), WriteError> {
        for (name, state) in SOLIDS.into_iter().zip([State::Closed, State::Open]) {
            let triangles = solids(&assembly.design, state, self.profile.sheet.thickness)
                .map_err(|(piece, error)| WriteError(format!("piece {piece}: {error}")))?;
            out.write::<WriteError>(name, |file| Ok(write_stl(triangles.iter().copied(), file)?))?;
        }
        let page =
            AssemblyPreview { assembly, heading: self.heading(), remark: &no_cut_file(&self.profile.name) };
        out.write::<WriteError>("preview.svg", |file| Ok(assembly::write(&page, file)?))
    }
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
