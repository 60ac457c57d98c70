//! What `make` and `fabricate` tell alike of what they made.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::super::table::labelled;
use super::super::{milled, morphs, solids};
use super::{Extras, Leaving};
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::plan::CutPlan;
use crate::fabrication::product::Product;
use crate::kirigami::design::State;
use crate::kirigami::quality::Quality;
use crate::machine::Machine;
use crate::output::folder::{
    ASSEMBLY_FILES, CUT_FILES, MILL_FILES, MORPH, OPEN_SHEET_FILES, SHEET_FILES, SNAP_FILES,
};
use crate::output::{design_json, hinge_report};
use crate::pipeline::mill::Milled;

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

/// What is printed of the cutting.
pub fn cut_lines(plan: Option<&CutPlan>) -> String {
    let lines = plan.iter().flat_map(|plan| plan.report.lines());
    lines.map(|line| format!("  {line}\n")).collect()
}

/// How a summary begins: what became of the run, its figures, and its hinges.
pub fn head(name: &str, outcome: &str, figures: &[(String, String)], hinges: &[HingeRow]) -> String {
    let hinges = hinge_report::summary(hinges).map(|summary| format!("  {summary}\n"));
    format!("{name}: {outcome}\n{}{}", labelled(figures), hinges.unwrap_or_default())
}

/// What is said at the end of a dry run: of a program all that it takes.
pub fn dry_run_lines(milled: Option<(&Milled, &Machine)>) -> String {
    let rows = milled.map_or_else(Vec::new, milled::statistics);
    labelled(&rows) + "A dry run: nothing was written.\n"
}

/// The last event: figures under their names in `design.json`, and the files.
pub fn event(product: &Product, quality: &Quality, extras: &Extras, leaving: &Leaving) -> Value {
    let Extras { solids: thick, moving, plan, .. } = extras;
    let hinges = hinge_report::summary(product.hinges());
    let figures: BTreeMap<&str, f64> = design_json::figures(quality).into();
    json!({
        "event": "result",
        "status": 0,
        "dry_run": leaving.dry_run,
        "folder": leaving.folder(),
        "files": leaving.files(product, extras),
        "pieces": product.design().pieces.len(),
        "hinges": product.hinges().len(),
        "hinges_to_look_at": hinges.as_ref().map_or(0, |summary| summary.warn),
        "max_strain": hinges.as_ref().map(|summary| summary.worst_strain.value),
        "figures": figures,
        "solids": thick.as_ref().map(solids::event),
        "morph": moving.as_ref().map(morphs::event),
        "cut": plan.as_ref().map(|plan| hinge_report::cut_object(&plan.report)),
        "mill": extras.milled().map(|(milled, machine)| milled::object(milled, machine)),
    })
}

/// The names of the files that are written.
pub(super) fn file_names(product: &Product, extras: &Extras) -> Vec<String> {
    let names: &[&str] = match product {
        Product::Sheet(sheet) if sheet.design.sheet_state == Some(State::Open) => &OPEN_SHEET_FILES,
        Product::Sheet(_) => &SHEET_FILES,
        Product::Assembly(_) => &ASSEMBLY_FILES,
    };
    let mut names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    if let Some(milled) = &extras.milled {
        names.retain(|name| !CUT_FILES.contains(&name.as_str()));
        names.splice(1..1, MILL_FILES.map(str::to_owned));
        names.splice(1..1, milled.program.files.iter().map(|(name, _)| name.clone()));
    }
    names.extend(extras.moving.iter().map(|_| MORPH.to_owned()));
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
