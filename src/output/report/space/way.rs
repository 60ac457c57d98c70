//! The figures of the way between the states, step by step, and what is to be said of it.

use serde_json::{Value, json};

use crate::morph::{Morph, Step};

/// Parts of an edge below which hinge points are said to stay together: a micrometre of pieces of 10 mm.
const STILL: f64 = 1e-4;
/// Steps apart by less than this part of the turn are not told apart.
const LEAST_STEP: f64 = 1e-6;
/// Parts of an edge by which the way may miss the closed state without a word.
const JUMP: f64 = 0.05;

/// Figures per step, angles in degrees; `shown`: how many of the steps the view has.
pub fn object(morph: &Morph, shown: usize) -> Value {
    let list = |figure: &dyn Fn(&Step) -> f64, digits: i32| -> Vec<f64> {
        let scale = 10.0_f64.powi(digits);
        morph.steps.iter().map(|step| (figure(step) * scale).round() / scale + 0.0).collect()
    };
    json!({
        "at": shares(morph).into_iter().map(|share| (share * 1e6).round() / 1e6).collect::<Vec<_>>(),
        "strain": list(&|step| step.strain, 8),
        "area": list(&|step| step.area_expansion, 5),
        "angle_min": list(&|step| step.angles[0].to_degrees(), 3),
        "angle_mean": list(&|step| step.angles[1].to_degrees(), 3),
        "angle_max": list(&|step| step.angles[2].to_degrees(), 3),
        "clashes": list(&|step| if step.collision.is_some() { 1.0 } else { 0.0 }, 0),
        "words": words(morph, shown),
    })
}

/// How far open every step is, 0 to 1: the part of their turn that its hinges have made, or where that does not grow from
/// step to step the step's place in the row.
pub fn shares(morph: &Morph) -> Vec<f64> {
    let mut shares: Vec<f64> = morph.steps.iter().map(|step| step.share).collect();
    if let [first, .., last] = shares.as_mut_slice() {
        (*first, *last) = (0.0, 1.0);
    }
    let grows = shares.windows(2).all(|pair| pair[1] - pair[0] > LEAST_STEP);
    if grows { shares } else { morph.steps.iter().map(|step| step.at).collect() }
}

fn words(morph: &Morph, shown: usize) -> Vec<String> {
    let share = |step: &Step| format!("{:.0} % of the turn", 100.0 * step.share);
    let worst = morph.worst();
    let mut words = Vec::new();
    if worst.strain < STILL {
        words.push("The sheet moves from one state to the other without strain.".to_owned());
    } else {
        let (parting, hinge) = worst.parting;
        words.push(format!(
            "It cannot move without strain: on the way found that is largest at {}, where the two points of hinge {hinge} would \
             part by {parting:.3} mm, {:.2} % of an edge (all hinges on average {:.3} mm); ligaments and pieces have to give \
             that much.",
            share(worst),
            100.0 * worst.strain,
            worst.mean_parting
        ));
    }
    match morph.collision() {
        Some((step, clash)) => {
            let [j, k] = clash.pieces;
            words.push(format!(
                "Thick pieces run into each other on the way, most at {}: pieces {j} and {k} by {:.3} mm, where {:.3} mm may \
                 pass.",
                share(step),
                clash.depth,
                clash.limit
            ));
        }
        None if morph.thick => words.push("Thick pieces do not run into each other on the way.".to_owned()),
        None => {
            words.push("Whether thick pieces run into each other on the way was not looked at.".to_owned())
        }
    }
    if morph.jump > JUMP {
        words.push(format!(
            "The way found begins {:.2} edges beside the closed state; the first step leads there at once.",
            morph.jump
        ));
    }
    if shown < morph.steps.len() {
        words.push(format!("Of so many pieces the view holds {shown} of {} steps.", morph.steps.len()));
    }
    words
}
