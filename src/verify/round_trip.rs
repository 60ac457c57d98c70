//! Random layouts come back from both files as they were written.

use kurbo::Point;

use super::{read_dxf, read_svg};
use crate::fabrication::layout::{CutKind, CutLayout, CutPath, PathVertex};
use crate::fabrication::test_sheet;
use crate::output::dxf::{self, DxfVersion};
use crate::output::svg;

/// Numbers from 0 to 1 that look random.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() * limit as f64) as usize
    }
}

/// A cut through random points; bulges up to `most`, none on the last vertex of an open cut.
fn path(kind: CutKind, closed: bool, size: [f64; 2], most: f64, numbers: &mut Numbers) -> CutPath {
    // Of two vertices nobody knows which is the first.
    let count = if closed { 3 } else { 2 } + numbers.below(6);
    let mut vertices: Vec<PathVertex> = (0..count)
        .map(|_| {
            // R12 has centre and angles with twelve decimals: arcs next to straight lose their ends by that.
            let bulge = most * 10f64.powf(-2.0 * numbers.next());
            let bulge = [0.0, bulge, -bulge][numbers.below(3)];
            PathVertex { point: Point::new(size[0] * numbers.next(), size[1] * numbers.next()), bulge }
        })
        .collect();
    if !closed {
        vertices[count - 1].bulge = 0.0;
    }
    CutPath { kind, vertices, closed }
}

fn layout(seed: u64, sheet: [f64; 2], most: f64) -> CutLayout {
    let mut numbers = Numbers(seed);
    let kinds = [CutKind::Slit, CutKind::Relief, CutKind::Window];
    let mut paths: Vec<CutPath> = (0..1 + numbers.below(20))
        .map(|_| {
            let kind = kinds[numbers.below(3)];
            path(kind, kind == CutKind::Window, sheet, most, &mut numbers)
        })
        .collect();
    paths.push(path(CutKind::Border, true, sheet, most, &mut numbers));
    CutLayout { sheet, kerf: 0.05, engravings: Vec::new(), paths, notes: Vec::new() }
}

/// Largest distance between the corners, and between the middles of the segments, of two cuts.
fn apart(a: &CutPath, b: &CutPath) -> f64 {
    let middle = |path: &CutPath, i: usize| {
        let (from, to) = (path.vertices[i], path.vertices[(i + 1) % path.vertices.len()]);
        // The arc's height is the bulge times half the chord, to the right of it where it turns left.
        from.point.midpoint(to.point) - 0.5 * from.bulge * (to.point - from.point).turn_90()
    };
    let count = a.vertices.len();
    let corners = (0..count).map(|i| a.vertices[i].point.distance(b.vertices[i].point));
    let segments = if a.closed { count } else { count - 1 };
    let middles = (0..segments).map(|i| middle(a, i).distance(middle(b, i)));
    corners.chain(middles).fold(0.0, f64::max)
}

/// The largest distance between what is written and what is read, of R2000, R12 and, where it is asked for, SVG.
fn worst(seeds: std::ops::Range<u64>, most: f64, with_svg: bool) -> [f64; 3] {
    let profile = test_sheet::profile();
    let sheet = [profile.sheet.width, profile.sheet.height];
    let mut worst = [0.0_f64; 3];
    for seed in seeds {
        let layout = layout(seed, sheet, most);
        let mut files = Vec::new();
        for version in [DxfVersion::R2000, DxfVersion::R12] {
            let mut bytes = Vec::new();
            dxf::write(&layout, version, &[], &mut bytes).unwrap();
            files.push(read_dxf::read(&bytes).unwrap());
        }
        if with_svg {
            let mut bytes = Vec::new();
            svg::write(&layout, &[], &mut bytes).unwrap();
            files.push(read_svg::read(&bytes, &profile).unwrap());
        }
        for (file, worst) in files.iter().zip(&mut worst) {
            assert_eq!(file.faults, [], "{seed}: {}", file.name);
            assert_eq!(file.paths.len(), layout.paths.len(), "{seed}: {}", file.name);
            for (read, ours) in file.paths.iter().zip(&layout.paths) {
                let shape = |path: &CutPath| (path.kind, path.closed, path.vertices.len());
                assert_eq!(shape(read), shape(ours), "{seed}: {}", file.name);
                *worst = worst.max(apart(read, ours));
            }
        }
    }
    println!("bulges up to {most}: R2000, R12, SVG off by {worst:?} mm");
    worst
}

#[test]
fn random_layouts_come_back() {
    // Arcs of at most a quarter turn, which the SVG has in one piece; it has six decimals, the DXF twelve.
    let small = worst(0..300, 0.41, true);
    assert!(small[0] < 1e-9 && small[1] < 1e-6 && small[2] < 1e-5, "{small:?}");
    let large = worst(300..500, 5.0, false);
    assert!(large[0] < 1e-9 && large[1] < 1e-5, "{large:?}");
}
