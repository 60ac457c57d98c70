//! The files of a laid-out design, which `make` and `fabricate` write alike.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};

use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::notes::applied_words;
use crate::fabrication::product::{Assembly, Product};
use crate::kirigami::design::State;
use crate::kirigami::quality::Quality;
use crate::output::design_json::{self, DesignFile, Provenance, Stage};
use crate::output::dxf::{self, DxfVersion};
use crate::output::exchange::{solids, write_stl};
use crate::output::folder::{ASSEMBLY_FILES, FolderError, OutputFolder, SHEET_FILES, SOLIDS};
use crate::output::preview::assembly::{self, AssemblyPreview};
use crate::output::preview::{self, Preview};
use crate::output::{hinge_report, svg};
use crate::pipeline::Timings;
use crate::profile::Profile;

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
    /// Measures of the design as it will be cut.
    pub quality: &'a Quality,
    /// What the solver did.
    pub stages: &'a [Stage],
    /// For which it was laid out.
    pub profile: &'a Profile,
    /// Version of the DXF.
    pub dxf: DxfVersion,
    /// Figures for the preview: label and value.
    pub figures: &'a [(String, String)],
}

impl Results<'_> {
    /// Writes all files but the times.
    ///
    /// # Errors
    /// What a writer refuses.
    pub fn write(&self, out: &OutputFolder) -> Result<(), WriteError> {
        let Self { product, profile, .. } = self;
        let hinges = product.hinges();
        let summary = hinge_report::summary(hinges);
        let design = DesignFile {
            design: product.design(),
            quality: self.quality,
            stages: self.stages,
            max_strain: summary.as_ref().map(|summary| summary.worst_strain.value),
            provenance: Provenance { job: self.name, target: self.target, hashes: self.hashes },
        };
        out.write::<WriteError>("design.json", |file| Ok(design_json::write(&design, file)?))?;
        out.write::<WriteError>("hinges.json", |file| Ok(hinge_report::write_json(hinges, profile, file)?))?;
        out.write::<WriteError>("hinges.csv", |file| Ok(hinge_report::write_csv(hinges, file)?))?;
        match product {
            Product::Sheet(sheet) => self.write_sheet(sheet, out),
            Product::Assembly(assembly) => self.write_assembly(assembly, out),
        }
    }

    /// The cut files and the page that shows them.
    fn write_sheet(&self, fabrication: &Fabrication, out: &OutputFolder) -> Result<(), WriteError> {
        let profile = self.profile;
        let comments = [
            format!("kirimorph {}, job {}, profile {}", env!("CARGO_PKG_VERSION"), self.name, profile.name),
            format!("millimetres; {}", applied_words(profile)),
        ];
        out.write::<WriteError>("cut.dxf", |file| {
            Ok(dxf::write(&fabrication.layout, self.dxf, &comments, file)?)
        })?;
        out.write::<WriteError>("cut.svg", |file| Ok(svg::write(&fabrication.layout, &comments, file)?))?;
        let preview = Preview {
            fabrication,
            title: self.name,
            profile: &profile.name,
            target: self.target,
            figures: self.figures,
        };
        out.write::<WriteError>("preview.svg", |file| Ok(preview::write(&preview, file)?))
    }

    /// The solids of the pieces in both states, and the page that shows them.
    fn write_assembly(&self, assembly: &Assembly, out: &OutputFolder) -> Result<(), WriteError> {
        for (name, state) in SOLIDS.into_iter().zip([State::Closed, State::Open]) {
            let triangles = solids(&assembly.design, state, self.profile.sheet.thickness)
                .map_err(|(piece, error)| WriteError(format!("piece {piece}: {error}")))?;
            out.write::<WriteError>(name, |file| Ok(write_stl(&triangles, file)?))?;
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

/// The names of the files that are written.
pub fn file_names(product: &Product) -> &'static [&'static str] {
    match product {
        Product::Sheet(_) => &SHEET_FILES,
        Product::Assembly(_) => &ASSEMBLY_FILES,
    }
}

/// What is said where a profile for a laser meets a design that no laser can cut from a sheet.
pub fn no_cut_file(profile: &str) -> String {
    format!(
        "Neither state is flat, so there is no sheet to cut and no flat cut file, though the profile {profile} is for a \
         laser: it gives the thickness of the solids and the ligaments in the hinge report. The pieces are to be made \
         one by one, and joined at their hinges. For a cut file give the job a flat closed or open target."
    )
}

/// Writes `timings.json`.
///
/// # Errors
/// The file system's refusal.
pub fn write_timings(timings: &Timings, out: &mut BufWriter<File>) -> Result<(), WriteError> {
    let stages: Vec<_> = timings
        .0
        .iter()
        .map(|(name, seconds)| serde_json::json!({ "name": name, "seconds": seconds }))
        .collect();
    serde_json::to_writer_pretty(&mut *out, &serde_json::json!({ "stages": stages }))?;
    Ok(writeln!(out)?)
}
