//! The hinges in the terminal: the worst ones in aligned columns, and all of them in one line.

use std::fmt;

use super::csv::fixed;
use super::{nearest_cut, verdict_name};
use crate::fabrication::hinge_table::{HingeRow, Verdict};

/// A figure at the hinge where it is most extreme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// The hinge's id.
    pub hinge: usize,
    /// The figure.
    pub value: f64,
}

/// All hinges of a sheet in a few figures. Displayed as one line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Hinges with the verdict ok.
    pub ok: usize,
    /// Hinges with the verdict warn.
    pub warn: usize,
    /// Hinges with the verdict fail.
    pub fail: usize,
    /// Largest nominal strain, dimensionless.
    pub worst_strain: Extreme,
    /// Largest distance of a ligament's centre from its hinge point, millimetres.
    pub largest_centre_offset: Extreme,
    /// Least width of a ligament, millimetres.
    pub narrowest_ligament: Extreme,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} hinges: {} ok, {} warn, {} fail; worst strain {} % (hinge {}), largest centre offset {} mm (hinge {}), \
             narrowest ligament {} mm (hinge {})",
            self.ok + self.warn + self.fail,
            self.ok,
            self.warn,
            self.fail,
            fixed(100.0 * self.worst_strain.value, 1),
            self.worst_strain.hinge,
            fixed(self.largest_centre_offset.value, 3),
            self.largest_centre_offset.hinge,
            fixed(self.narrowest_ligament.value, 3),
            self.narrowest_ligament.hinge,
        )
    }
}

/// Counts the verdicts and finds the extremes; the first hinge of equal ones. `None` without hinges. A figure that is
/// not a number counts as the worst.
pub fn summary(rows: &[HingeRow]) -> Option<Summary> {
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let largest = |figure: fn(&HingeRow) -> f64| {
        let worse = |best: Extreme, row: &HingeRow| match figure(row) {
            value if (value.is_nan() && !best.value.is_nan()) || value > best.value => {
                Extreme { hinge: row.id, value }
            }
            _ => best,
        };
        let first = rows.first()?;
        Some(rows.iter().fold(Extreme { hinge: first.id, value: figure(first) }, worse))
    };
    let narrowest = largest(|row| -row.width)?;
    Some(Summary {
        ok: count(Verdict::Ok),
        warn: count(Verdict::Warn),
        fail: count(Verdict::Fail),
        worst_strain: largest(|row| row.strain)?,
        largest_centre_offset: largest(|row| row.centre_offset)?,
        narrowest_ligament: Extreme { value: -narrowest.value, ..narrowest },
    })
}

/// Headings; the first [`NUMBERS`] columns are numbers and stand at the right.
const HEADINGS: [&str; 13] = [
    "hinge",
    "pieces",
    "x mm",
    "y mm",
    "angle",
    "tilt",
    "width",
    "length",
    "offset",
    "next cut",
    "strain",
    "verdict",
    "class, reason",
];
const NUMBERS: usize = 11;

/// The worst `count` hinges as an aligned table (failing ones first, then warnings, then by strain), followed by the
/// line of the [`Summary`]. Lengths are millimetres, angles degrees.
pub fn table(rows: &[HingeRow], count: usize) -> String {
    let Some(summary) = summary(rows) else { return "no hinges\n".into() };
    let mut worst: Vec<&HingeRow> = rows.iter().collect();
    worst.sort_by(|a, b| b.verdict.cmp(&a.verdict).then(b.strain.total_cmp(&a.strain)).then(a.id.cmp(&b.id)));
    let mut lines = vec![HEADINGS.map(String::from)];
    lines.extend(worst.into_iter().take(count).map(cells));
    let mut text = String::new();
    if lines.len() > 1 {
        let widths: [usize; HEADINGS.len()] =
            std::array::from_fn(|i| lines.iter().map(|line| line[i].chars().count()).max().unwrap_or(0));
        for line in &lines {
            text.push_str(&aligned(line, &widths));
            text.push('\n');
        }
    }
    text + &summary.to_string() + "\n"
}

fn cells(row: &HingeRow) -> [String; HEADINGS.len()] {
    let reason = if row.reason.is_empty() { String::new() } else { format!("; {}", row.reason) };
    [
        row.id.to_string(),
        format!("{} {}", row.pieces[0], row.pieces[1]),
        fixed(row.point.x, 2),
        fixed(row.point.y, 2),
        fixed(row.angle.to_degrees(), 1),
        fixed(row.tilt.to_degrees(), 1),
        fixed(row.width, 3),
        fixed(row.length, 2),
        fixed(row.centre_offset, 3),
        nearest_cut(row).map_or("-".into(), |distance| fixed(distance, 2)),
        format!("{} %", fixed(100.0 * row.strain, 1)),
        verdict_name(row.verdict).into(),
        format!("{}, {}{reason}", row.strain_class, row.fatigue),
    ]
}

fn aligned(line: &[String; HEADINGS.len()], widths: &[usize; HEADINGS.len()]) -> String {
    let padded = line.iter().zip(widths).enumerate().map(|(i, (cell, &width))| match i {
        _ if i < NUMBERS => format!("{cell:>width$}"),
        _ => format!("{cell:<width$}"),
    });
    padded.collect::<Vec<_>>().join("  ").trim_end().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::mechanics::{Fatigue, StrainClass};
    use crate::geometry::{Point3, Vector3};

    fn row(id: usize, verdict: Verdict, strain: f64, width: f64, centre_offset: f64) -> HingeRow {
        HingeRow {
            id,
            pieces: [id, 100 + id],
            point: Point3::new(10.0, -20.5, 0.0),
            axis: Vector3::z(),
            tilt: 0.0,
            angle: 1.5,
            width,
            length: 1.0,
            pole_offset: 0.0,
            centre_offset,
            nearest_cut: f64::INFINITY,
            strain,
            strain_class: StrainClass::PlasticLowCycle,
            effective_length: 1.0,
            stiffness: 1000.0,
            conditioned_stiffness: None,
            heat_margin: None,
            width_margin: 0.1,
            torque: None,
            fatigue: Fatigue::SingleDeployment,
            verdict,
            reason: if verdict == Verdict::Ok { String::new() } else { "because".into() },
        }
    }

    fn rows() -> Vec<HingeRow> {
        vec![
            row(0, Verdict::Ok, 0.30, 0.5, 0.0),
            row(1, Verdict::Warn, 0.10, 0.5, 0.031),
            row(2, Verdict::Ok, 0.35, 0.49, 0.0),
            row(3, Verdict::Fail, 0.20, 0.5, 0.0),
            row(14, Verdict::Ok, 0.35, 0.49, 0.0),
        ]
    }

    #[test]
    fn worst_first_and_aligned() {
        let text = table(&rows(), 4);
        let lines: Vec<&str> = text.lines().collect();
        let ids: Vec<&str> = lines[1..5].iter().map(|line| line.split_whitespace().next().unwrap()).collect();
        // Fail, warn, then by strain; equal strains in order.
        assert_eq!(ids, ["3", "1", "2", "14"]);
        // Numbers end in the column of their heading's end, verdicts start at their heading's start.
        let end = lines[0].find("strain").unwrap() + "strain".len();
        let start = lines[0].find("verdict").unwrap();
        for (line, [strain, verdict]) in lines[1..5].iter().zip([
            ["20.0 %", "fail"],
            ["10.0 %", "warn"],
            ["35.0 %", "ok"],
            ["35.0 %", "ok"],
        ]) {
            assert!(line[..end].ends_with(strain) && line[start..].starts_with(verdict), "{line}");
        }
        assert!(lines[1].ends_with("plastic low-cycle, single deployment; because"));
        assert_eq!(lines.len(), 6);
        assert_eq!(
            lines[5],
            "5 hinges: 3 ok, 1 warn, 1 fail; worst strain 35.0 % (hinge 2), largest centre offset 0.031 mm (hinge 1), \
             narrowest ligament 0.490 mm (hinge 2)"
        );
        assert_eq!(table(&rows(), 0).lines().count(), 1);
        assert_eq!((table(&[], 4).as_str(), summary(&[])), ("no hinges\n", None));
    }

    #[test]
    fn a_figure_that_is_not_a_number_is_the_worst() {
        let mut rows = rows();
        rows[1].width = f64::NAN;
        rows[4].strain = f64::NAN;
        let summary = summary(&rows).unwrap();
        assert!(summary.narrowest_ligament.hinge == 1 && summary.narrowest_ligament.value.is_nan());
        assert_eq!(summary.worst_strain.hinge, 14);
        assert!(table(&rows, 3).lines().nth(3).unwrap().trim_start().starts_with("14"));
    }
}
