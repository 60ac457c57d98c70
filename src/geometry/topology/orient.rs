//! Turning faces over so that neighbours agree.

use super::{by_edge, sorted_half_edges};

/// Turns faces over so that neighbours run through their common edge in opposite directions, and tells which ones.
/// In each component the fewer are turned, and at a tie those that agree with its first face stay.
///
/// Edges of more than two faces tell nothing. Where no choice agrees ([`super::Defect::OneSided`]) some faces
/// still disagree.
pub fn orient(faces: &mut [Vec<usize>]) -> Vec<usize> {
    let half_edges = sorted_half_edges(faces);
    let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); faces.len()];
    for group in by_edge(&half_edges) {
        if let [a, b] = group {
            let turned = a.ascends == b.ascends;
            neighbours[a.face].push((b.face, turned));
            neighbours[b.face].push((a.face, turned));
        }
    }
    let mut turned = vec![None; faces.len()];
    for start in 0..faces.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut component = vec![start];
        let mut at = 0;
        while let Some(&face) = component.get(at) {
            for &(neighbour, other) in &neighbours[face] {
                if turned[neighbour].is_none() {
                    turned[neighbour] = turned[face].map(|turned| turned != other);
                    component.push(neighbour);
                }
            }
            at += 1;
        }
        let count = component.iter().filter(|&&face| turned[face] == Some(true)).count();
        if 2 * count > component.len() {
            component.iter().for_each(|&face| turned[face] = turned[face].map(|turned| !turned));
        }
    }
    let turned: Vec<usize> = (0..faces.len()).filter(|&face| turned[face] == Some(true)).collect();
    turned.iter().for_each(|&face| faces[face].reverse());
    turned
}

#[cfg(test)]
mod tests {
    use super::super::{Defect, disk};
    use super::*;

    #[test]
    fn the_fewer_faces_are_turned() {
        let sheet = vec![vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![3, 4, 7, 6], vec![4, 5, 8, 7]];
        for wrong in 0..4 {
            let mut faces = sheet.clone();
            faces[wrong].reverse();
            assert!(matches!(disk(&faces), Err(Defect::Winding { .. })));
            assert_eq!(orient(&mut faces), [wrong]);
            assert_eq!(disk(&faces), disk(&sheet));
        }
        let mut faces = sheet.clone();
        assert_eq!(orient(&mut faces), [0_usize; 0]);
    }

    #[test]
    fn a_moebius_strip_stays_one_sided() {
        let mut faces: Vec<Vec<usize>> =
            (0..5).map(|i| vec![2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect();
        faces[4] = vec![8, 1, 0, 9];
        orient(&mut faces);
        assert!(matches!(disk(&faces), Err(Defect::OneSided { .. })));
    }
}
