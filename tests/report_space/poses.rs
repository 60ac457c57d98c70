//! The poses that a page holds, decoded here anew and compared with the design beside it.

use std::path::Path;

use serde_json::Value;

use crate::program::{design, number};
use crate::{hinges, numbers};

type Vector = [f64; 3];

/// What base64 stands for (RFC 4648), in whole numbers of two bytes.
fn whole_numbers(text: &str) -> Vec<i16> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    let (mut bits, mut count) = (0_u32, 0);
    for c in text.bytes().filter(|&c| c != b'=') {
        (bits, count) = ((bits << 6 | u32::from(digit(c))) & 0xffff, count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect()
}

struct Pose {
    place: Vector,
    turn: [f64; 4],
}

impl Pose {
    /// Turned by the quaternion (i, j, k, w), or back where `sense` is -1.
    fn turned(&self, v: Vector, sense: f64) -> Vector {
        let [i, j, k, w] = self.turn;
        let [i, j, k] = [sense * i, sense * j, sense * k];
        let square = |a: f64, b: f64| 1.0 - 2.0 * (a * a + b * b);
        let rows = [
            [square(j, k), 2.0 * (i * j - k * w), 2.0 * (i * k + j * w)],
            [2.0 * (i * j + k * w), square(i, k), 2.0 * (j * k - i * w)],
            [2.0 * (i * k - j * w), 2.0 * (j * k + i * w), square(i, j)],
        ];
        rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    fn apply(&self, v: Vector) -> Vector {
        let turned = self.turned(v, 1.0);
        [0, 1, 2].map(|i| turned[i] + self.place[i])
    }

    fn undo(&self, v: Vector) -> Vector {
        self.turned([0, 1, 2].map(|i| v[i] - self.place[i]), -1.0)
    }
}

fn poses(space: &Value) -> Vec<Pose> {
    let unit = number(space, "place_unit");
    let numbers = whole_numbers(space["poses"].as_str().unwrap());
    let pose = |pose: &[i16]| {
        let turn: [f64; 4] = std::array::from_fn(|i| f64::from(pose[3 + i]) / f64::from(i16::MAX));
        let length = turn.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-4, "a quaternion of length {length}");
        Pose { place: std::array::from_fn(|i| unit * f64::from(pose[i])), turn: turn.map(|c| c / length) }
    };
    numbers.chunks_exact(7).map(pose).collect()
}

fn distance(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// In both end states the two pieces of every hinge hold its point in one place, and those points are as far apart as the
/// design has them: the page shows the design, wherever it stands.
pub fn check_poses(folder: &Path) {
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let data: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    let (space, design, hinges) = (&data["space"], design(folder), hinges(folder));
    let poses = poses(space);
    let count = design["pieces"].as_array().unwrap().len();
    let steps = numbers(&space["at"]);
    assert_eq!(poses.len(), count * steps.len());
    assert!((steps[0], steps[steps.len() - 1]) == (0.0, 1.0) && steps.is_sorted(), "{steps:?}");
    let rest = space["rest"]["step"].as_u64().unwrap() as usize;
    let to_page = numbers(&space["rest"]["page"]);
    let on_page = |p: &[f64]| -> Vector {
        std::array::from_fn(|i| (0..3).map(|j| to_page[4 * i + j] * p[j]).sum::<f64>() + to_page[4 * i + 3])
    };
    // Rounded places and turns, the latter on a lever of a piece.
    let reach = number(space, "outline_unit") * f64::from(i16::MAX);
    let slack = 4.0 * number(space, "place_unit") + 4.0 * reach / f64::from(i16::MAX) + 1e-3;
    for (state, step) in [("closed", 0), ("open", steps.len() - 1)] {
        let mut before: Option<[Vector; 2]> = None;
        for (row, hinge) in hinges.iter().zip(design["hinges"].as_array().unwrap()) {
            let point = on_page(&numbers(&row["point"]));
            let pieces = numbers(&row["pieces"]).into_iter().map(|piece| piece as usize);
            let ends: Vec<Vector> = pieces
                .map(|piece| poses[step * count + piece].apply(poses[rest * count + piece].undo(point)))
                .collect();
            assert!(distance(ends[0], ends[1]) < slack, "{state}: {row} {ends:?}");
            let [piece, vertex] = ["pieces", "vertices"].map(|key| hinge[key][0].as_u64().unwrap() as usize);
            let wanted = numbers(&design["pieces"][piece][state][vertex]);
            let wanted = [wanted[0], wanted[1], wanted[2]];
            if let Some([seen, known]) = before {
                let (shown, true_one) = (distance(seen, ends[0]), distance(known, wanted));
                assert!((shown - true_one).abs() < 2.0 * slack, "{state}: {row} {shown} {true_one}");
            }
            before = Some([ends[0], wanted]);
        }
    }
}
