//! The files of a laid-out design, which `make` and `fabricate` write alike.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};

use crate::fabrication::fabricate::Fabrication;
use crate::kirigami::quality::Quality;
use crate::output::design_json::{self, DesignFile, Provenance, Stage};
use crate::output::dxf::{self, DxfVersion};
use crate::output::folder::{FolderError, OutputFolder};
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
    /// The checked sheet.
    pub fabrication: &'a Fabrication,
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
        let Self { fabrication, profile, .. } = self;
        let summary = hinge_report::summary(&fabrication.hinges);
        let design = DesignFile {
            design: &fabrication.design,
            quality: self.quality,
            stages: self.stages,
            max_strain: summary.as_ref().map(|summary| summary.worst_strain.value),
            provenance: Provenance { job: self.name, target: self.target, hashes: self.hashes },
        };
        out.write::<WriteError>("design.json", |file| Ok(design_json::write(&design, file)?))?;
        let comments = [
            format!("kirimorph {}, job {}, profile {}", env!("CARGO_PKG_VERSION"), self.name, profile.name),
            format!("millimetres; kerf {} mm already applied: cut on the line", profile.laser.kerf),
        ];
        out.write::<WriteError>("cut.dxf", |file| {
            Ok(dxf::write(&fabrication.layout, self.dxf, &comments, file)?)
        })?;
        out.write::<WriteError>("cut.svg", |file| Ok(svg::write(&fabrication.layout, &comments, file)?))?;
        out.write::<WriteError>("hinges.json", |file| {
            Ok(hinge_report::write_json(&fabrication.hinges, profile, file)?)
        })?;
        out.write::<WriteError>("hinges.csv", |file| {
            Ok(hinge_report::write_csv(&fabrication.hinges, file)?)
        })?;
        let preview = Preview {
            fabrication,
            title: self.name,
            profile: &profile.name,
            target: self.target,
            figures: self.figures,
        };
        out.write::<WriteError>("preview.svg", |file| Ok(preview::write(&preview, file)?))
    }
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
