use kurbo::Point;

use super::first_way::gap;
use super::*;
use crate::fabrication::closed_sheet;
use crate::fabrication::test_sheet::{TestSheet, profile, sheets};

/// The cuts of a regular closed sheet, as they are made, and its ligaments.
fn closed(cells: [usize; 2]) -> (Vec<CutPath>, Vec<Point>) {
    let sheet = TestSheet::rectangle(cells, [10.0, 10.0], profile().hinge_gap());
    let design = sheet.design(sheet.full_angle());
    let lengths = vec![1.0; design.hinges.len()];
    let ligaments = design.hinges.iter().map(|hinge| Point::new(hinge.point.x, hinge.point.y)).collect();
    (closed_sheet::cuts_of(&design, &profile(), &lengths).unwrap().0.paths, ligaments)
}

fn ratio(order: &[CutPath]) -> f64 {
    let travel = travel(order);
    travel.length / travel.bound
}

/// A cut as numbers that do not depend on its direction, nor where a closed one begins.
fn key(path: &CutPath) -> (CutKind, usize, [i64; 3]) {
    let points = path.flatten(1e-3);
    let length: f64 = path.segments(1e-3).iter().map(|[a, b]| a.distance(*b)).sum();
    let middle = match path.closed {
        true => Point::ORIGIN,
        false => points[0].midpoint(points[points.len() - 1]),
    };
    (path.kind, usize::from(path.closed), [length, middle.x, middle.y].map(|v| (1e6 * v).round() as i64))
}

/// Numbers in 0..100 that look random.
fn numbers(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed;
    let next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        100.0 * (state >> 33) as f64 / (1_u64 << 31) as f64
    };
    std::iter::repeat_with(next).take(count).collect()
}

fn points(seed: u64, count: usize) -> Vec<Point> {
    numbers(seed, 2 * count).chunks_exact(2).map(|pair| Point::new(pair[0], pair[1])).collect()
}

/// Prim's rule with all distances.
fn slow_tree(groups: &[Vec<Point>]) -> f64 {
    let distance = |a: usize, b: usize| {
        let pairs = groups[a].iter().flat_map(|p| groups[b].iter().map(|q| p.distance(*q)));
        pairs.fold(f64::INFINITY, f64::min)
    };
    let mut left: Vec<(usize, f64)> = (1..groups.len()).map(|i| (i, distance(0, i))).collect();
    let mut length = 0.0;
    while let Some(k) = (0..left.len()).min_by(|&a, &b| left[a].1.total_cmp(&left[b].1)) {
        let (next, step) = left.swap_remove(k);
        length += step;
        left.iter_mut().for_each(|(i, way)| *way = way.min(distance(*i, next)));
    }
    length
}

#[test]
fn the_bound_is_the_minimum_spanning_tree() {
    for (seed, count) in [(1, 2), (2, 3), (3, 40), (4, 300)] {
        let groups: Vec<Vec<Point>> =
            points(seed, 3 * count).chunks(3).enumerate().map(|(i, p)| p[..1 + i % 3].to_vec()).collect();
        let (found, slow) = (spanning_tree(&groups), slow_tree(&groups));
        assert!((found - slow).abs() < 1e-9 * slow, "{count}: {found} {slow}");
    }
    // Two crowds far apart, all of whose listed neighbours are at home.
    let crowd = |x: f64| (0..30).map(move |i| vec![Point::new(x + 0.01 * f64::from(i), 0.0)]);
    let groups: Vec<Vec<Point>> = crowd(0.0).chain(crowd(50.0)).chain(crowd(-70.0)).collect();
    assert!((spanning_tree(&groups) - slow_tree(&groups)).abs() < 1e-9);
    // Equal distances everywhere.
    let lattice: Vec<Vec<Point>> =
        (0..225).map(|i| vec![Point::new(f64::from(i % 15), f64::from(i / 15))]).collect();
    assert!((spanning_tree(&lattice) - 224.0).abs() < 1e-9);
    assert_eq!((spanning_tree(&[]), spanning_tree(&lattice[..1])), (0.0, 0.0));
}

/// Length of the best way by trying all.
fn best_way(stops: &[[End; 2]], at: End, onwards: &dyn Fn(Point) -> f64) -> f64 {
    if stops.is_empty() {
        return onwards(at[0]).min(onwards(at[1]));
    }
    let mut best = f64::INFINITY;
    for i in 0..stops.len() {
        let mut rest = stops.to_vec();
        let [a, b] = rest.swap_remove(i);
        for [enter, leave] in [[a, b], [b, a]] {
            best = best.min(gap(at, enter) + best_way(&rest, leave, onwards));
        }
    }
    best
}

#[test]
fn the_ascent_lies_between_the_tree_and_the_shortest_way() {
    let (mut trees, mut ascents, mut shortest) = (0.0, 0.0, 0.0);
    for seed in 0..20 {
        let ends = points(seed, 12);
        let stops: Vec<[Point; 2]> = ends.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        let onwards = |p: Point| 100.0 - p.x.max(p.y);
        let best = best_way(&plain(&stops), [HOME; 2], &onwards);
        let ways: Vec<f64> = ends.iter().map(|&end| onwards(end)).collect();
        let mut groups: Vec<Vec<Point>> = stops.iter().map(|stop| stop.to_vec()).collect();
        groups.push(vec![HOME]);
        let tree = spanning_tree(&groups) + ways.iter().copied().fold(f64::INFINITY, f64::min);
        let ascent = ascent::ascent(&ends, HOME, &ways, 1.1 * best);
        assert!(tree <= ascent + 1e-9 && ascent <= best + 1e-9, "{seed}: {tree} {ascent} {best}");
        (trees, ascents, shortest) = (trees + tree, ascents + ascent, shortest + best);
    }
    assert!(shortest - ascents < 0.3 * (shortest - trees), "{trees} {ascents} {shortest}");
    // Two cuts in a row, from the origin: the way is 1 + 2 + 5, and so is the bound.
    let ends = [1.0, 3.0, 5.0, 6.0].map(|x| Point::new(x, 0.0));
    let bound = ascent::ascent(&ends, HOME, &[9.0, 9.0, 9.0, 5.0], 8.0);
    assert!((bound - 8.0).abs() < 1e-9, "{bound}");
}

/// Stops without bars.
fn plain(stops: &[[Point; 2]]) -> Vec<[End; 2]> {
    stops.iter().map(|stop| stop.map(|end| [end; 2])).collect()
}

#[test]
fn small_tours_are_the_shortest_of_all() {
    let onwards = |p: Point| 100.0 - p.x.max(p.y);
    for seed in 0..40 {
        let places = points(seed, 24);
        // Without bars, and with.
        let stops: Vec<[End; 2]> = match seed % 2 {
            0 => places.chunks_exact(4).map(|p| [[p[0]; 2], [p[1]; 2]]).collect(),
            _ => places.chunks_exact(4).map(|p| [[p[0], p[1]], [p[2], p[3]]]).collect(),
        };
        let way = tour(&stops, &Frame { home: HOME, onwards: &onwards });
        let (mut at, mut length) = ([HOME; 2], 0.0);
        for (stop, back) in way {
            let [enter, leave] = if back { [stops[stop][1], stops[stop][0]] } else { stops[stop] };
            length += gap(at, enter);
            at = leave;
        }
        length += onwards(at[0]).min(onwards(at[1]));
        let best = best_way(&stops, [HOME; 2], &onwards);
        assert!(length < best * (1.0 + 1e-9), "{seed}: {length} {best}");
    }
}

#[test]
fn every_cut_is_made_once_with_its_bars_and_the_border_last() {
    for (sheet, phi) in sheets() {
        let design = sheet.design(phi);
        let lengths = vec![1.0; design.hinges.len()];
        let paths = closed_sheet::cuts_of(&design, &profile(), &lengths).unwrap().0.paths;
        let ligaments: Vec<Point> =
            design.hinges.iter().map(|hinge| Point::new(hinge.point.x, hinge.point.y)).collect();
        let order = cutting_order(&paths, &ligaments);
        let keys = |paths: &[CutPath]| {
            let mut keys: Vec<_> = paths.iter().map(key).collect();
            keys.sort();
            keys
        };
        assert!(keys(&paths) == keys(&order));
        assert_eq!(order, cutting_order(&paths, &ligaments));
        // A window may lie anywhere before the border, but after all that is open.
        let rank = |path: &CutPath| [CutKind::Window, CutKind::Border].iter().position(|&k| k == path.kind);
        assert!(order.windows(2).all(|pair| rank(&pair[0]) <= rank(&pair[1])));
        // Every bar is next to the slit that ends in its middle.
        for (i, bar) in order.iter().enumerate().filter(|(_, path)| path.kind == CutKind::Relief) {
            let middle = first(bar).midpoint(last(bar));
            let meets = |other: &CutPath| {
                other.kind == CutKind::Slit
                    && first(other).distance(middle).min(last(other).distance(middle)) < 1e-6
            };
            assert!(i > 0 && meets(&order[i - 1]) || meets(&order[i + 1]), "bar {i}");
        }
        // The border begins well away from ligaments.
        let begin = first(&order[order.len() - 1]);
        assert!(ligaments.iter().all(|at| at.distance(begin) >= CLEAR), "{begin}");
    }
}

#[test]
fn travel_is_near_its_bound() {
    // 24 to 419 slits with bars; and without, where the ways across ligaments count for more.
    for (cells, limit) in
        [([5, 5], 1.3), ([10, 10], 1.12), ([20, 20], 1.06), ([20, 21], 1.06), ([31, 33], 1.06)]
    {
        let (paths, ligaments) = closed(cells);
        let bare: Vec<CutPath> = paths.iter().filter(|path| path.kind != CutKind::Relief).cloned().collect();
        let ratios = [paths, bare].map(|paths| ratio(&cutting_order(&paths, &ligaments)));
        println!("{cells:?}: {ratios:?}");
        assert!(ratios.iter().all(|&ratio| (1.0..=limit).contains(&ratio)), "{cells:?}: {ratios:?}");
    }
}

#[test]
fn the_order_in_which_cuts_come_and_lie_matters_little() {
    let (paths, ligaments) = closed([14, 13]);
    let mut mixed: Vec<CutPath> = paths.iter().rev().cloned().collect();
    mixed.rotate_left(77);
    for path in mixed.iter_mut().step_by(3) {
        *path = directed(path, true);
    }
    let [one, other] = [&paths, &mixed].map(|paths| travel(&cutting_order(paths, &ligaments)));
    // The bound depends on the cuts alone; the way found within a few hundredths.
    assert!((one.bound - other.bound).abs() < 1e-6, "{one:?} {other:?}");
    assert!((one.length / other.length - 1.0).abs() < 0.04, "{one:?} {other:?}");
}

#[test]
fn turning_an_arc_keeps_its_place() {
    let vertex = |x: f64, y: f64, bulge: f64| PathVertex { point: Point::new(x, y), bulge };
    let vertices =
        vec![vertex(0.0, 0.0, 0.5), vertex(2.0, 0.0, 0.0), vertex(3.0, 1.0, -0.2), vertex(4.0, 0.0, 0.0)];
    let path = CutPath { kind: CutKind::Slit, vertices, closed: false };
    let back = directed(&path, true);
    let mut points = back.flatten(1e-3);
    points.reverse();
    assert!(points.iter().zip(path.flatten(1e-3)).all(|(a, b)| a.distance(b) < 1e-12));
    assert_eq!(directed(&back, true), path);
}
