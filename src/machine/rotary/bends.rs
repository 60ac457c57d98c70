//! Where a path bends: there the slits end, and beside their ends the ligaments stand.

use super::Station;

/// Change of direction within a tool's diameter that counts as a bend, radians.
const BEND: f64 = 0.5;

/// For each station of a run the length of path to the nearest bend; infinite where there is none.
pub(super) fn distances(stations: &[Station], diameter: f64) -> Vec<f64> {
    let mut lengths = vec![0.0; stations.len()];
    let mut turns = vec![0.0; stations.len()];
    let mut direction: Option<nalgebra::Vector2<f64>> = None;
    for i in 1..stations.len() {
        let step = stations[i].pose.tip - stations[i - 1].pose.tip;
        // Down and up along the axis the path goes nowhere.
        let along = step.xy().norm() > 0.5 * step.z.abs() + 1e-6;
        let step = if along { step.xy() } else { nalgebra::Vector2::zeros() };
        lengths[i] = lengths[i - 1] + step.norm();
        turns[i] = turns[i - 1];
        if along {
            if let Some(before) = direction {
                turns[i] += before.perp(&step).atan2(before.dot(&step)).abs();
            }
            direction = Some(step);
        }
    }
    // A station bends if the path's direction changes by more than a bend within half a diameter on either
    // side.
    let bends: Vec<bool> = (0..stations.len())
        .map(|i| {
            let low = lengths.partition_point(|&length| length < lengths[i] - diameter / 2.0);
            let high = lengths.partition_point(|&length| length <= lengths[i] + diameter / 2.0);
            // The turn at the station after the window's last belongs to a corner that stands in it.
            turns[high.min(turns.len() - 1)] - turns[low] > BEND
        })
        .collect();
    let mut distances = vec![f64::INFINITY; stations.len()];
    let mut nearest = f64::NEG_INFINITY;
    for i in 0..stations.len() {
        nearest = if bends[i] { lengths[i] } else { nearest };
        distances[i] = lengths[i] - nearest;
    }
    let mut nearest = f64::INFINITY;
    for i in (0..stations.len()).rev() {
        nearest = if bends[i] { lengths[i] } else { nearest };
        distances[i] = distances[i].min(nearest - lengths[i]);
    }
    distances
}
