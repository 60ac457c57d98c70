//! The files of a laid-out design, which `make` and `fabricate` write alike.

mod files;

mod page;

mod told;

use std::io;
use std::path::Path;

use self::files::write_timings;
use super::check::refuse_failing;
use super::morphs::{self, Moving};
use super::{Failure, solids};
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::hinge_table::Verdict;
use crate::fabrication::plan::{CutOptions, CutPlan, cut_plan};
use crate::fabrication::product::Product;
use crate::kirigami::quality::{Limits, Quality};
use crate::machine::Machine;
use crate::output::design_json::{self, DesignFile, Provenance, Stage};
use crate::output::dxf::{self, DxfVersion};
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::preview;
use crate::output::report::Seen;
use crate::output::{hinge_report, svg};
use crate::pipeline::mill::Milled;
use crate::pipeline::{Clock, fingerprint};
use crate::profile::Profile;
use crate::snap::assess::Snap;
use crate::solid::ThickSheet;
use crate::verify::{self, Fault, Files, ReadError, Wanted};

pub use told::{cut_lines, dry_run_lines, event, head, no_cut_file, outcome};

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
    /// What `design.json` holds.
    pub file: DesignFile<'a>,
    /// The checked sheet, or the pieces where neither state is flat.
    pub product: &'a Product,
    /// What became of the run: [`outcome`].
    pub outcome: &'a str,
    /// What was made of it besides.
    pub extras: &'a Extras<'a>,
    /// What the report shows of the targets.
    pub seen: Seen<'a>,
    /// What the design had to keep.
    pub limits: &'a Limits,
    /// For which it was laid out.
    pub profile: &'a Profile,
    /// Version of the DXF.
    pub dxf: DxfVersion,
    /// Figures for the preview: label and value.
    pub figures: &'a [(String, String)],
}

/// What `design.json` is to hold of a product.
pub fn design_file<'a>(
    product: &'a Product,
    quality: &'a Quality,
    stages: &'a [Stage],
    provenance: Provenance<'a>,
) -> DesignFile<'a> {
    let summary = hinge_report::summary(product.hinges());
    DesignFile {
        design: product.design(),
        quality,
        stages,
        max_strain: summary.as_ref().map(|summary| summary.worst_strain.value),
        provenance,
    }
}

/// The hash of `design.json` as it will be written.
///
/// # Errors
/// A design that cannot be written.
pub fn design_hash(file: &DesignFile) -> Result<String, WriteError> {
    let mut bytes = Vec::new();
    design_json::write(file, &mut bytes)?;
    Ok(fingerprint(&bytes))
}

/// What is made of a product besides its layout.
pub struct Extras<'a> {
    /// The sheet's solids; `None` where neither state is flat.
    pub solids: Option<ThickSheet>,
    /// The way between the states, where it was followed.
    pub moving: Option<Moving>,
    /// How the sheet is cut, where there is one.
    pub plan: Option<CutPlan>,
    /// How a bistable sheet snaps.
    pub snap: Option<Snap>,
    /// What mills the sheet; `None` for a laser.
    pub machine: Option<&'a Machine>,
    /// Its program.
    pub milled: Option<Milled>,
}

impl<'a> Extras<'a> {
    /// Solids, way and cuts of a product whose hinges hold or may fail; neither snap nor program yet.
    ///
    /// # Errors
    /// A failing hinge that is not allowed, what cannot be made of thick material, what the sheet has no room for.
    pub fn new(
        product: &Product,
        profile: &Profile,
        options: &CutOptions,
        machine: Option<&'a Machine>,
        allow_failing: bool,
        clock: &mut Clock,
    ) -> Result<Self, Failure> {
        refuse_failing(product.hinges(), allow_failing)?;
        let solids = clock.run("solids", |_| solids::solids(product, profile))?;
        let moving = clock.run("morph", |_| morphs::moving(product, profile))?;
        let plan = match product {
            Product::Sheet(sheet) => {
                let plan = clock.run("plan", |_| cut_plan(sheet, profile, options));
                Some(plan.map_err(|error| Failure::NotMakeable(error.to_string()))?)
            }
            Product::Assembly(_) => None,
        };
        Ok(Self { solids, moving, plan, snap: None, machine, milled: None })
    }

    /// The program of a sheet that is milled, and the machine that takes it.
    pub fn milled(&self) -> Option<(&Milled, &'a Machine)> {
        self.milled.as_ref().zip(self.machine)
    }
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
    /// Makes sure before the work that its results can be left.
    ///
    /// # Errors
    /// A place that is no folder of results.
    pub fn check(&self) -> Result<(), Failure> {
        if self.dry_run { Ok(()) } else { OutputFolder::check(self.folder).map_err(Failure::bad_input) }
    }

    /// The folder that holds the files.
    pub fn folder(&self) -> Option<&Path> {
        (!self.dry_run).then_some(self.folder)
    }

    /// The names of the files in it.
    pub fn files(&self, product: &Product, extras: &Extras) -> Vec<String> {
        if self.dry_run { Vec::new() } else { told::file_names(product, extras) }
    }
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
        let Extras { plan, milled, .. } = self.extras;
        if let (Product::Sheet(sheet), Some(plan), None) = (self.product, plan, milled) {
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
}
