//! The files of a laid-out design, which `make` and `fabricate` write alike.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::morphs::{self, Moving};
use super::{Failure, milled, setup_sheet};
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::notes::applied_words;
use crate::fabrication::plan::{CutOptions, CutPlan, cut_plan};
use crate::fabrication::product::{Assembly, Product};
use crate::kirigami::design::State;
use crate::kirigami::quality::{Limits, Quality};
use crate::machine::Machine;
use crate::output::design_json::{self, DesignFile, Provenance, Stage};
use crate::output::dxf::{self, DxfVersion};
use crate::output::exchange::{solids, write_stl};
use crate::output::folder::{
    ASSEMBLY_FILES, CUT_FILES, FolderError, MILL_FILES, MORPH, MOVED, OPEN_SHEET_FILES, OutputFolder, PART,
    REPORT, SHEET_FILES, SNAP_FILES, SOLIDS,
};
use crate::output::preview::assembly::{self, AssemblyPreview};
use crate::output::preview::{self, Preview};
use crate::output::report::{self, Report, Seen};
use crate::output::{glb, hinge_report, snap_report, svg, toolpath_svg};
use crate::pipeline::mill::Milled;
use crate::pipeline::{Clock, Timings, fingerprint};
use crate::profile::Profile;
use crate::snap::assess::Snap;
use crate::solid::ThickSheet;
use crate::verify::{self, Fault, Files, ReadError, Wanted};

/// Anything that can go wrong while results are written.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct WriteError(String);

macro_rules! write_error_from {
    ($($error:ty),*) => {
        $(impl From<$error> for WriteError {
            fn from(error: $error) -> Self {
                Self(error.to_string())
            }
        })*
    };
}

write_error_from!(
    io::Error,
    FolderError,
    design_json::WriteDesignError,
    dxf::WriteDxfError,
    svg::WriteSvgError,
    hinge_report::WriteHingesError,
    ReadError,
    preview::WritePreviewError,
    serde_json::Error
);

/// What goes into the files.
pub struct Results<'a> {
    /// Name of the job or the design.
    pub name: &'a str,
    /// File name of the target, or where the design comes from.
    pub target: &'a str,
    /// Hashes of input files by name.
    pub hashes: &'a BTreeMap<String, String>,
    /// The checked sheet, or the pieces where neither state is flat.
    pub product: &'a Product,
    /// What became of the run: [`outcome`].
    pub outcome: &'a str,
    /// What was made of it besides.
    pub extras: Extras<'a>,
    /// Measures of the design as it will be cut.
    pub quality: &'a Quality,
    /// What they had to keep.
    pub limits: &'a Limits,
    /// What the solver did.
    pub stages: &'a [Stage],
    /// For which it was laid out.
    pub profile: &'a Profile,
    /// Version of the DXF.
    pub dxf: DxfVersion,
    /// Figures for the preview: label and value.
    pub figures: &'a [(String, String)],
}

/// What is made of a product besides its layout.
#[derive(Clone, Copy)]
pub struct Extras<'a> {
    /// The sheet's solids; `None` where neither state is flat.
    pub solids: Option<&'a ThickSheet>,
    /// How a bistable sheet snaps.
    pub snap: Option<&'a Snap>,
    /// The way between the states, where it was followed.
    pub moving: Option<&'a Moving>,
    /// How the sheet is cut, where there is one.
    pub plan: Option<&'a CutPlan>,
    /// The program of a sheet that is milled, and the machine that takes it.
    pub milled: Option<(&'a Milled, &'a Machine)>,
    /// What the report shows of the targets.
    pub seen: Seen<'a>,
}

/// What the person at the mill needs to know.
#[derive(Default)]
struct Setup {
    rows: Vec<(&'static str, String)>,
    restarts: Vec<String>,
}

/// What becomes of the results.
#[derive(Clone, Copy)]
pub struct Leaving<'a> {
    /// Where they go.
    pub folder: &'a Path,
    /// Leave files whose hinges fail, where their verdict says so.
    pub allow_failing: bool,
    /// Say what would be made, and write nothing.
    pub dry_run: bool,
}

impl Leaving<'_> {
    /// The folder that holds the files.
    pub fn folder(&self) -> Option<&Path> {
        (!self.dry_run).then_some(self.folder)
    }

    /// The names of the files in it.
    pub fn files(&self, product: &Product, extras: Extras) -> Vec<String> {
        if self.dry_run { Vec::new() } else { file_names(product, extras) }
    }
}

/// What is said at the end of a dry run: of a program all that it takes.
pub fn dry_run_lines(milled: Option<(&Milled, &Machine)>) -> String {
    let rows = milled.map_or_else(Vec::new, milled::statistics);
    let width = rows.iter().map(|(label, _)| label.len()).max().unwrap_or(0);
    let lines = rows.iter().map(|(label, value)| format!("  {label:<width$}  {value}\n"));
    lines.chain(["A dry run: nothing was written.\n".to_owned()]).collect()
}

/// How many faults of one check are told of files that are not left.
const FAULTS_TOLD: usize = 3;

impl Results<'_> {
    /// Writes all files, reads the machine files back, and puts the folder in its place: all or nothing. A dry run ends before.
    ///
    /// # Errors
    /// What a writer refuses; machine files that are not what the design asks for.
    pub fn leave(&self, leaving: &Leaving, clock: &mut Clock) -> Result<(), Failure> {
        let Leaving { folder, allow_failing, dry_run } = *leaving;
        if dry_run {
            return Ok(());
        }
        let refused = |error: WriteError| Failure::BadInput(format!("cannot write the results: {error}"));
        let out = clock
            .run("output", |_| -> Result<OutputFolder, WriteError> {
                let out = OutputFolder::create(folder)?;
                self.write(&out)?;
                Ok(out)
            })
            .map_err(refused)?;
        if let (Product::Sheet(sheet), Some(plan), None) =
            (self.product, self.extras.plan, self.extras.milled)
        {
            let faults =
                clock.run("verify", |_| self.verify(sheet, plan, &out, allow_failing)).map_err(refused)?;
            if !faults.is_empty() {
                return Err(Failure::NotMakeable(format!(
                    "the machine files are not what the design asks for, so none was left:\n{}This should not happen: \
                     report it with the job",
                    verify::faults(&faults, FAULTS_TOLD)
                )));
            }
        }
        let times = |out: OutputFolder| -> Result<(), WriteError> {
            out.write("timings.json", |file| write_timings(&clock.timings, file))?;
            Ok(out.finish()?)
        };
        times(out).map_err(refused)
    }

    /// What is wrong with the machine files that were written.
    fn verify(
        &self,
        sheet: &Fabrication,
        plan: &CutPlan,
        out: &OutputFolder,
        allow_failing: bool,
    ) -> Result<Vec<Fault>, WriteError> {
        let [design, dxf, svg] = ["design.json", "cut.dxf", "cut.svg"].map(|name| out.read(name));
        let hash = fingerprint(&design?);
        let wanted = Wanted {
            design: &sheet.design,
            profile: self.profile,
            hash: &hash,
            copies: &plan.report.copies,
            tabs: plan.report.tabs.as_ref(),
        };
        let mut faults = verify::verify(Files { dxf: &dxf?, svg: &svg? }, wanted)?.faults;
        // What the hinge report tells of a hinge is no surprise: that it fails, or that its ligament stands off its point.
        let told = |id: usize| {
            let row = &sheet.hinges[id];
            let off = row.centre_offset > verify::CENTRE_TOLERANCE && row.verdict != Verdict::Ok;
            off || (allow_failing && row.verdict == Verdict::Fail)
        };
        faults.retain(|fault| !fault.hinge.is_some_and(told));
        Ok(faults)
    }

    /// What `design.json` is to hold.
    fn design_file(&self) -> DesignFile<'_> {
        let summary = hinge_report::summary(self.product.hinges());
        DesignFile {
            design: self.product.design(),
            quality: self.quality,
            stages: self.stages,
            max_strain: summary.as_ref().map(|summary| summary.worst_strain.value),
            provenance: Provenance { job: self.name, target: self.target, hashes: self.hashes },
        }
    }

    /// The hash of `design.json` as it will be written.
    ///
    /// # Errors
    /// A design that cannot be written.
    pub fn design_hash(&self) -> Result<String, WriteError> {
        let mut bytes = Vec::new();
        design_json::write(&self.design_file(), &mut bytes)?;
        Ok(fingerprint(&bytes))
    }

    /// Writes all files but the times.
    fn write(&self, out: &OutputFolder) -> Result<(), WriteError> {
        let Self { product, profile, .. } = self;
        let hinges = product.hinges();
        out.write::<WriteError>("design.json", |file| Ok(design_json::write(&self.design_file(), file)?))?;
        out.write::<WriteError>("hinges.json", |file| {
            let mill = self.extras.milled.map(|(milled, machine)| milled::object(milled, machine));
            let cut = self.extras.plan.map(|plan| &plan.report);
            Ok(hinge_report::write_json(hinges, profile, cut, mill.as_ref(), file)?)
        })?;
        out.write::<WriteError>("hinges.csv", |file| Ok(hinge_report::write_csv(hinges, file)?))?;
        if let Some(snap) = self.extras.snap {
            let [json, svg] = SNAP_FILES;
            let object = snap_report::object(snap, &profile.name);
            out.write::<WriteError>(json, |file| Ok(writeln!(file, "{object:#}")?))?;
            out.write::<WriteError>(svg, |file| Ok(snap_report::write_plot(snap, self.name, file)?))?;
        }
        if let Some(Moving { morph, bodies }) = self.extras.moving {
            let scene = glb::Scene { name: self.name, design: product.design(), bodies, morph };
            out.write::<WriteError>(MORPH, |file| Ok(glb::write(&scene, file)?))?;
        }
        out.write::<WriteError>(REPORT, |file| {
            Ok(report::write(&self.report(&self.remarks(), &self.cutting(), &self.setup()), file)?)
        })?;
        match (product, self.extras.plan) {
            (Product::Sheet(sheet), Some(plan)) => self.write_sheet(sheet, plan, out),
            (Product::Sheet(_), None) => Err(WriteError("a sheet without a plan for cutting".to_owned())),
            (Product::Assembly(assembly), _) => self.write_assembly(assembly, out),
        }
    }

    /// What the page tells that a person decides by.
    fn report<'b>(&'b self, remarks: &'b [String], cutting: &'b [String], setup: &'b Setup) -> Report<'b> {
        Report {
            job: self.name,
            target: self.target,
            outcome: self.outcome,
            product: self.product,
            quality: self.quality,
            limits: self.limits,
            stages: self.stages,
            profile: self.profile,
            figures: self.figures,
            remarks,
            snap: self.extras.snap,
            plan: self.extras.plan,
            cutting,
            setup: &setup.rows,
            restarts: &setup.restarts,
            seen: Seen { morph: self.extras.moving.map(|moving| &moving.morph), ..self.extras.seen },
        }
    }

    /// What the summary says of cutting or milling.
    fn cutting(&self) -> Vec<String> {
        match (self.extras.milled, self.extras.plan) {
            (Some(milled), _) => milled::lines(milled).lines().map(|line| line.trim().to_owned()).collect(),
            (None, Some(plan)) => plan.report.lines(),
            (None, None) => Vec::new(),
        }
    }

    /// The set-up sheet of a sheet that is milled.
    fn setup(&self) -> Setup {
        self.extras.milled.map_or_else(Setup::default, |(milled, machine)| Setup {
            rows: setup_sheet::rows(milled, self, machine),
            restarts: std::iter::once(setup_sheet::AGAIN.to_owned())
                .chain(setup_sheet::restarts(milled))
                .collect(),
        })
    }

    /// What the summary says besides figures, hinges, cuts and snap.
    fn remarks(&self) -> Vec<String> {
        let mut remarks: Vec<String> = Vec::new();
        if let Some(thick) = self.extras.solids {
            remarks.extend(super::solids::summary(thick).lines().map(|line| line.trim().to_owned()));
        }
        let way = morphs::summary(self.extras.moving, self.product.hinges().len());
        remarks.extend(way.lines().map(|line| line.trim().to_owned()));
        if matches!(self.product, Product::Assembly(_)) {
            remarks.push(no_cut_file(&self.profile.name));
        }
        let copies = self.extras.plan.map_or(1, |plan| plan.report.copies.len());
        if copies > 1 {
            remarks.push(format!("The drawing shows the first of {copies} copies."));
        }
        remarks
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
            format!("kirimorph {}, job {}, profile {}", env!("CARGO_PKG_VERSION"), self.name, profile.name),
            format!("millimetres; {}", applied_words(profile)),
            verify::hash_comment(&fingerprint(&out.read("design.json")?)),
        ];
        if let Some((milled, machine)) = self.extras.milled {
            self.write_program(milled, machine, &comments, out)?;
        } else {
            out.write::<WriteError>("cut.dxf", |file| {
                Ok(dxf::write(&plan.layout, self.dxf, &comments, file)?)
            })?;
            out.write::<WriteError>("cut.svg", |file| Ok(svg::write(&plan.layout, &comments, file)?))?;
        }
        if let Some(solids) = self.extras.solids {
            let moved = MOVED[usize::from(fabrication.design.sheet_state == Some(State::Open))];
            for (name, mesh) in [(PART, &solids.part), (moved, &solids.moved)] {
                out.write::<WriteError>(name, |file| Ok(write_stl(mesh.triangles(), file)?))?;
            }
        }
        let preview = Preview {
            fabrication,
            title: self.name,
            profile: &profile.name,
            target: self.target,
            groove: if self.extras.milled.is_some() { "tool" } else { "kerf" },
            made_from: match self.extras.milled {
                Some(_) => "the mill runs the program",
                None => "cut cut.dxf or cut.svg",
            },
            figures: self.figures,
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
        let page = AssemblyPreview {
            assembly,
            title: self.name,
            profile: &self.profile.name,
            target: self.target,
            figures: self.figures,
            remark: &no_cut_file(&self.profile.name),
        };
        out.write::<WriteError>("preview.svg", |file| Ok(assembly::write(&page, file)?))
    }
}

/// What became of a run, in words: what was `done`, and how many hinges fail or are to be looked at.
pub fn outcome(done: &str, hinges: &[HingeRow]) -> String {
    let count = |verdict| hinges.iter().filter(|row| row.verdict == verdict).count();
    let mut words = done.to_owned();
    if count(Verdict::Fail) > 0 {
        words += &format!(", with {} failing hinges", count(Verdict::Fail));
    }
    if count(Verdict::Warn) > 0 {
        words += &format!(", with {} hinges to look at", count(Verdict::Warn));
    }
    words
}

/// How a sheet is cut; `None` where there is no sheet.
///
/// # Errors
/// What the sheet has no room for.
pub fn plan(
    product: &Product,
    profile: &Profile,
    options: &CutOptions,
    clock: &mut Clock,
) -> Result<Option<CutPlan>, Failure> {
    let Product::Sheet(sheet) = product else { return Ok(None) };
    let plan = clock.run("plan", |_| cut_plan(sheet, profile, options));
    plan.map(Some).map_err(|error| Failure::NotMakeable(error.to_string()))
}

/// What is printed of the cutting.
pub fn cut_lines(plan: Option<&CutPlan>) -> String {
    let lines = plan.iter().flat_map(|plan| plan.report.lines());
    lines.map(|line| format!("  {line}\n")).collect()
}

/// The names of the files that are written.
fn file_names(product: &Product, extras: Extras) -> Vec<String> {
    let names: &[&str] = match product {
        Product::Sheet(sheet) if sheet.design.sheet_state == Some(State::Open) => &OPEN_SHEET_FILES,
        Product::Sheet(_) => &SHEET_FILES,
        Product::Assembly(_) => &ASSEMBLY_FILES,
    };
    let mut names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    if let Some((milled, _)) = extras.milled {
        names.retain(|name| !CUT_FILES.contains(&name.as_str()));
        names.splice(1..1, MILL_FILES.map(str::to_owned));
        names.splice(1..1, milled.program.files.iter().map(|(name, _)| name.clone()));
    }
    names.extend(extras.moving.map(|_| MORPH.to_owned()));
    names.extend(extras.snap.iter().flat_map(|_| SNAP_FILES.map(str::to_owned)));
    names
}

/// What is said where a profile for a laser meets a design that no laser can cut from a sheet.
pub fn no_cut_file(profile: &str) -> String {
    format!(
        "Neither state is flat, so there is no sheet to cut, no part.stl and no flat cut file, though the profile {profile} \
         is for cutting sheets: it gives the thickness of the solids and the ligaments in the hinge report. The pieces are to be \
         made one by one, and joined at their hinges. For a cut file give the job a flat closed or open target."
    )
}

/// Writes `timings.json`.
fn write_timings(timings: &Timings, out: &mut BufWriter<File>) -> Result<(), WriteError> {
    let stages: Vec<_> = timings
        .0
        .iter()
        .map(|(name, seconds)| serde_json::json!({ "name": name, "seconds": seconds }))
        .collect();
    serde_json::to_writer_pretty(&mut *out, &serde_json::json!({ "stages": stages }))?;
    Ok(writeln!(out)?)
}
