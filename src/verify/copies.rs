//! A sheet with several copies of a part: each is measured by itself, where the design lies.

use kurbo::{Affine, Rect, Vec2};

use super::Figures;
use super::cut_name;
use super::fault::{Check, Fault};
use super::machine_file::MachineFile;
use crate::fabrication::cuts::bounding_box;
use crate::fabrication::layout::{CutKind, CutPath};

/// How far a border may lie from where its copy should, millimetres.
const OFF: f64 = 0.01;

/// Measures every copy. `file`: with one closed border for every copy, the last of all cuts. Cuts are counted within
/// their copy.
pub(super) fn each(
    file: &MachineFile,
    copies: &[Vec2],
    faults: &mut Vec<Fault>,
    measure: impl Fn(&MachineFile) -> (Figures, Vec<Fault>),
) -> Vec<Figures> {
    let first = file.paths.len() - copies.len();
    let boxes: Vec<Rect> = file.paths[first..].iter().map(box_of).collect();
    // The design's own copy is the lower left one.
    let own =
        boxes.iter().copied().min_by(|a, b| (a.y0 + a.x0).total_cmp(&(b.y0 + b.x0))).unwrap_or_default();
    let mut parts: Vec<MachineFile> = copies.iter().map(|_| MachineFile::new(file.name)).collect();
    let mut borders: Vec<Option<CutPath>> = vec![None; copies.len()];
    for (index, path) in file.paths.iter().enumerate() {
        let centre = box_of(path).center();
        let part = copies.iter().position(|&by| (own + by).inflate(OFF, OFF).contains(centre));
        let Some(part) = part else {
            let says = "lies in none of the copies that hinges.json tells of";
            faults.push(Fault::new(Check::Copies, file.name, cut_name(&file.paths, index), centre, says));
            continue;
        };
        let cut = moved(path, -copies[part]);
        match path.kind {
            CutKind::Border => {
                let found = box_of(&cut);
                let off = [found.x0 - own.x0, found.y0 - own.y0, found.x1 - own.x1, found.y1 - own.y1];
                let off = off.into_iter().map(f64::abs).fold(0.0, f64::max);
                if off > OFF {
                    let says =
                        format!("lies {off:.3} mm from where copy {part} should be, the limit is {OFF} mm");
                    faults.push(Fault::new(
                        Check::Copies,
                        file.name,
                        cut_name(&file.paths, index),
                        centre,
                        says,
                    ));
                }
                borders[part] = Some(cut);
            }
            _ => parts[part].paths.push(cut),
        }
    }
    let mut all = Vec::with_capacity(copies.len());
    for (part, (mut cuts, border)) in parts.into_iter().zip(borders).enumerate() {
        let Some(border) = border else {
            let at = (own + copies[part]).center();
            faults.push(Fault::new(Check::Copies, file.name, format!("copy {part}"), at, "has no border"));
            continue;
        };
        cuts.paths.push(border);
        let (figures, found) = measure(&cuts);
        faults.extend(found.into_iter().map(|fault| Fault {
            what: format!("copy {part}, {}", fault.what),
            at: fault.at.map(|at| at + copies[part]),
            ..fault
        }));
        all.push(figures);
    }
    all
}

fn box_of(path: &CutPath) -> Rect {
    bounding_box(std::slice::from_ref(path))
}

fn moved(path: &CutPath, by: Vec2) -> CutPath {
    let mut path = path.clone();
    path.vertices.iter_mut().for_each(|vertex| vertex.point = Affine::translate(by) * vertex.point);
    path
}
