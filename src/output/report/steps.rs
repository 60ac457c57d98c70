//! What to do with the sheet once it is cut, in words.

use serde_json::{Value, json};

use super::Report;
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::mechanics::{StrainClass, springback};
use crate::fabrication::product::Product;
use crate::kirigami::design::{Design, PatternKind};
use crate::output::preview::opening::{Bend, Opening};

/// Titles and texts in order.
pub fn steps(report: &Report) -> Vec<Value> {
    let design = report.product.design();
    let rows = report.product.hinges();
    let mut steps = vec![face(report.product)];
    if !rows.is_empty() {
        steps.push(bending(design, rows));
        steps.push(deploying(report.product));
        steps.extend(holding(report, rows));
        steps.push(lasting(rows));
    }
    steps.into_iter().map(|(title, text)| json!({ "title": title, "text": text })).collect()
}

type Step = (&'static str, String);

fn face(product: &Product) -> Step {
    let Product::Sheet(sheet) = product else {
        let text = "No state is flat: the pieces are made one by one and joined at their hinges. The drawing shows the \
                    closed state from above.";
        return ("Pieces.", text.to_owned());
    };
    let becomes = match Opening::new(&sheet.design).bend {
        Bend::Flat => "the sheet stays nearly flat",
        Bend::Convex => "the sheet bulges towards you: that face becomes convex",
        Bend::Concave => "the sheet sinks away from you like a bowl: that face becomes concave",
        Bend::Mixed => "that face becomes partly convex, partly concave, like a saddle or a wave",
    };
    let text = format!(
        "The drawing shows the sheet from above, as it lies on the machine. That face becomes the side of the target that \
         the target's normals point to; {becomes}. Mark it before the part is taken out."
    );
    ("This face up.", text)
}

fn bending(design: &Design, rows: &[HingeRow]) -> Step {
    let who = match design.pattern {
        PatternKind::Bistable => {
            "The rectangles turn, blue ones counter-clockwise and yellow ones clockwise as seen from above; the pieces \
             between them are only shifted."
        }
        _ => {
            "Blue pieces turn counter-clockwise and yellow ones clockwise as seen from above, so neighbours turn against \
             each other."
        }
    };
    let [least, most] = range(rows.iter().map(|row| row.angle.to_degrees()));
    let text = format!(
        "{who} Each hinge turns by {least:.1} to {most:.1} degrees. Ligaments bend sideways, in the plane of the pieces; \
         nothing folds."
    );
    ("Which way hinges bend.", text)
}

fn deploying(product: &Product) -> Step {
    let design = product.design();
    let closes = matches!(product, Product::Sheet(sheet) if Opening::new(&sheet.design).closes);
    let text = match (design.pattern, closes) {
        (PatternKind::Bistable, false) => {
            "Hold the border and pull outwards until the cells snap, from one side to the other; then push back the \
             ones that have not. In between the sheet is strained: do not stop halfway."
        }
        (PatternKind::Bistable, true) => {
            "Push the border together until the cells snap, from one side to the other. In between the sheet is \
             strained: do not stop halfway."
        }
        (_, false) => {
            "Hold the border at many places and pull it outwards evenly, going round several times, while the middle \
             follows to its side; a form below helps. It is open when the hinges have turned by the angles of the table: \
             do not go further."
        }
        (_, true) => {
            "Push the border together evenly from all sides, going round several times, until the windows are closed."
        }
    };
    ("How to deploy it.", text.to_owned())
}

fn holding(report: &Report, rows: &[HingeRow]) -> Vec<Step> {
    let profile = report.heading.profile;
    let (elastic, yielding): (Vec<&HingeRow>, Vec<&HingeRow>) =
        rows.iter().partition(|row| row.strain_class == StrainClass::Elastic);
    let mut steps = Vec::new();
    if let Some(snap) = report.snap {
        let rest = if snap.sheet.bistable {
            format!(
                "By the elastic model it stays put by itself, at {:.0} % of its turns.",
                100.0 * snap.sheet.released.share
            )
        } else {
            format!(
                "By the elastic model it does not stay put: let go, it goes back to {:.0} % of its turns.",
                100.0 * snap.sheet.released.share
            )
        };
        steps.push(("At rest.", rest));
    }
    if !elastic.is_empty() {
        let torque: f64 = elastic.iter().filter_map(|row| row.torque).sum();
        let text = format!(
            "{} of {} hinges stay elastic and spring back: the shape has to be held, by a frame along its border or on a form. \
             At the full angle their torques add up to {torque:.0} N mm.",
            elastic.len(),
            rows.len()
        );
        steps.push(("How to hold it.", text));
    }
    if !yielding.is_empty() {
        let back = |row: &&HingeRow| springback(profile, row.length, row.angle).to_degrees();
        let [least, most] = range(yielding.iter().map(back));
        let text = format!(
            "{} of {} hinges yield and stay bent, but when let go each turns back by about {least:.1} to {most:.1} degrees \
             (bending of a section that yields without hardening): turn it further by that much, or fix the shape. Turning \
             back and forth uses hinges up.",
            yielding.len(),
            rows.len()
        );
        steps.push(("Springback.", text));
    }
    steps
}

fn lasting(rows: &[HingeRow]) -> Step {
    let mut lives: Vec<(String, usize)> = Vec::new();
    for life in rows.iter().map(|row| row.fatigue.to_string()) {
        match lives.iter_mut().find(|(known, _)| *known == life) {
            Some((_, count)) => *count += 1,
            None => lives.push((life, 1)),
        }
    }
    lives.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    const NAMED: usize = 4;
    let named: Vec<String> =
        lives.iter().take(NAMED).map(|(life, count)| format!("{life} ({count} hinges)")).collect();
    let more = if lives.len() > NAMED { ", others as the table's hinges tell" } else { "" };
    ("How often.", format!("Life between 0 and the full angle: {}{more}.", named.join(", ")))
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}
