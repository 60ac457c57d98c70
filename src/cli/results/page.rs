//! What `report.html` is told besides the results themselves.

use super::super::{milled, morphs, setup_sheet};
use super::{Results, no_cut_file};
use crate::fabrication::product::Product;
use crate::output::report::{Report, Seen};

/// What the person at the mill needs to know.
#[derive(Default)]
pub(super) struct Setup {
    rows: Vec<(&'static str, String)>,
    restarts: Vec<String>,
}

impl Results<'_> {
    /// What the page tells that a person decides by.
    pub(super) fn report<'b>(
        &'b self,
        remarks: &'b [String],
        cutting: &'b [String],
        setup: &'b Setup,
    ) -> Report<'b> {
        Report {
            heading: self.heading(),
            outcome: self.outcome,
            product: self.product,
            quality: self.file.quality,
            limits: self.limits,
            stages: self.file.stages,
            remarks,
            snap: self.extras.snap.as_ref(),
            plan: self.extras.plan.as_ref(),
            cutting,
            setup: &setup.rows,
            restarts: &setup.restarts,
            seen: Seen { morph: self.extras.moving.as_ref().map(|moving| &moving.morph), ..self.seen },
        }
    }

    /// What the summary says of cutting or milling.
    pub(super) fn cutting(&self) -> Vec<String> {
        match (self.extras.milled(), &self.extras.plan) {
            (Some(milled), _) => milled::lines(milled).lines().map(|line| line.trim().to_owned()).collect(),
            (None, Some(plan)) => plan.report.lines(),
            (None, None) => Vec::new(),
        }
    }

    /// The set-up sheet of a sheet that is milled.
    pub(super) fn setup(&self) -> Setup {
        self.extras.milled().map_or_else(Setup::default, |(milled, machine)| Setup {
            rows: setup_sheet::rows(milled, self, machine),
            restarts: std::iter::once(setup_sheet::AGAIN.to_owned())
                .chain(setup_sheet::restarts(milled))
                .collect(),
        })
    }

    /// What the summary says besides figures, hinges, cuts and snap.
    pub(super) fn remarks(&self) -> Vec<String> {
        let mut remarks: Vec<String> = Vec::new();
        if let Some(thick) = &self.extras.solids {
            remarks.extend(super::super::solids::summary(thick).lines().map(|line| line.trim().to_owned()));
        }
        let way = morphs::summary(self.extras.moving.as_ref(), self.product.hinges().len());
        remarks.extend(way.lines().map(|line| line.trim().to_owned()));
        if matches!(self.product, Product::Assembly(_)) {
            remarks.push(no_cut_file(&self.profile.name));
        }
        let copies = self.extras.plan.as_ref().map_or(1, |plan| plan.report.copies.len());
        if copies > 1 {
            remarks.push(format!("The drawing shows the first of {copies} copies."));
        }
        remarks
    }
}
