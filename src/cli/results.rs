//! The files of a laid-out design, which `make` and `fabricate` write alike.

mod files;

mod page;

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use self::files::write_timings;
use super::morphs::Moving;
use super::{Failure, milled};
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::plan::{CutOptions, CutPlan, cut_plan};
use crate::fabrication::product::Product;
use crate::kirigami::design::State;
use crate::kirigami::quality::{Limits, Quality};
use crate::machine::Machine;
use crate::output::design_json::{self, DesignFile, Provenance, Stage};
use crate::output::dxf::{self, DxfVersion};
use crate::output::folder::{
    ASSEMBLY_FILES, CUT_FILES, FolderError, MILL_FILES, MORPH, OPEN_SHEET_FILES, OutputFolder, SHEET_FILES,
    SNAP_FILES,
};
use crate::output::preview;
use crate::output::report::Seen;
use crate::output::{hinge_report, svg};
use crate::pipeline::mill::Milled;
use crate::pipeline::{Clock, fingerprint};
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
