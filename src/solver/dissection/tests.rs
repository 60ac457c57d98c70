//! Tests of the order of elimination.

use super::super::examples::{grid, structures};
use super::super::fronts::Fronts;
use super::*;

/// The part and those above it.
fn upwards(parts: &[Part], part: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(part), |&part| parts[part].parent)
}

#[test]
fn orders_each_unknown_once_and_parents_come_later() {
    for structure in structures() {
        let Dissection { order, parts } = dissect(&structure.places, &structure.cliques());
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..structure.places.len() as u32), "{}", structure.name);
        assert_eq!(parts.iter().map(|part| part.size).sum::<usize>(), order.len(), "{}", structure.name);
        let is_later = |(i, part): (usize, &Part)| part.parent.is_none_or(|parent| parent > i);
        assert!(parts.iter().enumerate().all(is_later), "{}", structure.name);
        assert!(parts.iter().all(|part| part.size > 0), "{}", structure.name);
    }
}

#[test]
fn separators_separate() {
    for structure in structures() {
        let Dissection { order, parts } = dissect(&structure.places, &structure.cliques());
        let mut part_of = vec![0; order.len()];
        let holders = parts.iter().enumerate().flat_map(|(i, part)| std::iter::repeat_n(i, part.size));
        order.iter().zip(holders).for_each(|(&unknown, part)| part_of[unknown as usize] = part);
        for coupling in &structure.couplings {
            let first = coupling.iter().map(|&u| part_of[u as usize]).min().unwrap();
            let above: Vec<usize> = upwards(&parts, first).collect();
            let on_one_branch = coupling.iter().all(|&u| above.contains(&part_of[u as usize]));
            assert!(on_one_branch, "{}: {coupling:?}", structure.name);
        }
    }
}

#[test]
fn a_grid_is_cut_by_its_shortest_lines() {
    for n in [20, 33, 64] {
        for per_point in [1, 3] {
            let grid = grid(n, per_point);
            let Dissection { parts, .. } = dissect(&grid.places, &grid.cliques());
            let top = parts.last().unwrap();
            assert_eq!((top.size, top.parent), (n * per_point, None));
            // Both halves are cut across: half a line each, and the row beside the line belongs to neither.
            let below = parts.iter().filter(|part| part.parent == Some(parts.len() - 1));
            let sizes: Vec<usize> = below.map(|part| part.size).collect();
            assert_eq!(sizes.len(), 2);
            let about_half =
                |&size: &usize| (per_point * (n / 3)..=per_point * n.div_ceil(2)).contains(&size);
            assert!(sizes.iter().all(about_half), "{n}: {sizes:?}");
        }
    }
}

#[test]
fn work_and_factor_grow_as_nested_dissection_says() {
    // Work as n^3, the factor as n^2 log n (George 1973), where the leaves' part is small already.
    let [small, large] = [64, 128].map(|n| {
        let grid = grid(n, 1);
        let fronts = Fronts::new(&grid.places, &grid.cliques());
        (fronts.work, fronts.factor_size as f64)
    });
    let (work, factor) = (large.0 / small.0, large.1 / small.1);
    assert!((6.0..9.0).contains(&work) && (4.0..5.5).contains(&factor), "{work} {factor}");
}
