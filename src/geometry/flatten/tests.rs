use super::*;
use crate::geometry::Point3;
use crate::geometry::stretch::{stretches, worst_ratio};

fn cycle(mesh: &TriMesh) -> Vec<usize> {
    crate::geometry::topology::disk(&mesh.faces).unwrap().boundary
}

/// A polar mesh of a surface of revolution given by (radius, height) over the arc length from the pole.
fn cap(rings: usize, sectors: usize, profile: impl Fn(f64) -> (f64, f64)) -> TriMesh {
    let mut vertices = vec![Point3::new(0.0, 0.0, profile(0.0).1)];
    for ring in 1..=rings {
        let (r, z) = profile(ring as f64 / rings as f64);
        for s in 0..sectors {
            let phi = 2.0 * PI * (s as f64 + 0.5 * (ring % 2) as f64) / sectors as f64;
            vertices.push(Point3::new(r * phi.cos(), r * phi.sin(), z));
        }
    }
    let at = |ring: usize, s: usize| 1 + (ring - 1) * sectors + s % sectors;
    let mut faces: Vec<[usize; 3]> = (0..sectors).map(|s| [0, at(1, s), at(1, s + 1)]).collect();
    for ring in 1..rings {
        for s in 0..sectors {
            // Rings are turned by half a sector against each other, alternately.
            let shift = ring % 2;
            let (a, b) = (at(ring, s), at(ring, s + 1));
            let (c, d) = (at(ring + 1, s + shift), at(ring + 1, s + 1 + shift));
            faces.extend([[a, c, b], [b, c, d]]);
        }
    }
    TriMesh { vertices, faces }
}

#[test]
fn stretch_ratio_of_spherical_caps_is_stereographic() {
    // The conformal flattening of a cap of opening angle alpha has scales 1 / (1 + cos theta).
    for alpha in [0.5, 1.0, PI / 2.0] {
        let mesh = cap(40, 96, |t| ((t * alpha).sin(), (t * alpha).cos()));
        let ratio = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap().ratio();
        let exact = 2.0 / (1.0 + alpha.cos());
        // Second order in the mesh size of 1/40.
        assert!((ratio / exact - 1.0).abs() < 2e-3, "{alpha}: {ratio} {exact}");
    }
}

#[test]
fn a_cone_free_developable_surface_keeps_its_lengths() {
    // A cylinder patch is developable: the flattening is an isometry of every triangle.
    let n = 12;
    let vertices: Vec<Point3> = (0..n * n)
        .map(|i| ((i % n) as f64 * 0.1, (i / n) as f64 * 0.1))
        .map(|(s, y)| Point3::new(s.cos(), y, s.sin()))
        .collect();
    let mut faces = Vec::new();
    for j in 0..n - 1 {
        for i in 0..n - 1 {
            let a = j * n + i;
            faces.push([a, a + 1, a + n + 1]);
            faces.push([a, a + n + 1, a + n]);
        }
    }
    let mesh = TriMesh { vertices, faces };
    let scale = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap();
    assert!((scale.ratio() - 1.0).abs() < 1e-12);
    let flat = flatten(&mesh, &scale, 1.0).unwrap();
    for face in &mesh.faces {
        for i in 0..3 {
            let (u, v) = (face[i], face[(i + 1) % 3]);
            let length = (mesh.vertices[u] - mesh.vertices[v]).norm();
            let laid = (flat.points[u] - flat.points[v]).norm();
            assert!((length - laid).abs() < 1e-9, "{length} {laid}");
        }
    }
}

#[test]
fn a_dome_is_flattened_with_small_distortion_and_no_fold() {
    let mesh = cap(30, 64, |t| ((t * 0.8).sin(), (t * 0.8).cos()));
    let scale = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap();
    let flat = flatten(&mesh, &scale, 1.0).unwrap();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for face in &mesh.faces {
        for i in 0..3 {
            let (u, v) = (face[i], face[(i + 1) % 3]);
            let stretch =
                (flat.points[u] - flat.points[v]).norm() / (mesh.vertices[u] - mesh.vertices[v]).norm();
            least = least.min(stretch);
            most = most.max(stretch);
        }
    }
    // Equal-boundary conformal scaling would spread over 2/(1+cos 0.8) = 1.18; rigidity halves the worst.
    assert!(least > 0.93 && most < 1.10, "{least} {most}");
}

#[test]
fn the_worst_stretch_of_a_cap_comes_near_the_least_possible() {
    // The least ratio for a spherical cap of opening angle alpha is alpha / sin alpha, that of the azimuthal
    // equidistant map (J. Milnor, A problem in cartography, 1969).
    for alpha in [0.8, 1.2, PI / 2.0] {
        let mesh = cap(30, 64, |t| ((t * alpha).sin(), (t * alpha).cos()));
        let scale = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap();
        let flat = flatten(&mesh, &scale, 1.0).unwrap();
        let found = worst_ratio(&stretches(&mesh, &flat.points));
        let least = alpha / alpha.sin();
        // The facets of the mesh are of the order of 1/30 of the cap.
        assert!(found > least * 0.99 && found < least * 1.02, "{alpha}: {found} {least}");
        // At least a third of the way from the as-rigid-as-possible map.
        assert!(found < flat.ratios[0] - (flat.ratios[0] - least) / 3.0, "{:?}", flat.ratios);
    }
}

#[test]
fn maps_within_the_bound_stay_as_rigid_as_possible() {
    let mesh = cap(20, 48, |t| ((t * 0.8).sin(), (t * 0.8).cos()));
    let scale = ConformalScale::solve(&mesh, &cycle(&mesh)).unwrap();
    let rigid = flatten(&mesh, &scale, 10.0).unwrap();
    assert_eq!(rigid.ratios.len(), 1);
    let bound = 0.8 * rigid.ratios[0] + 0.2 * 0.8 / 0.8_f64.sin();
    let bounded = flatten(&mesh, &scale, bound).unwrap();
    assert!(bounded.ratios.last().is_some_and(|&ratio| ratio <= bound), "{:?}", bounded.ratios);
}
