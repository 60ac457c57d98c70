//! Stage 1 of patterns whose pieces come from a mesh: the user's, or one that is aligned with the map.

use std::path::Path;

use super::aims::{Aim, Aims, Outline, surface};
use super::error::PipelineError;
use super::stage1::{Begun, MOST_OPENING, begun, middle_to_middle};
use super::surfaces::{TargetMesh, Targets, first_axis};
use crate::geometry::boundary::BoundaryCurve;
use crate::geometry::closest::ClosestPoints;
use crate::geometry::flatten::conformal_points;
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::read::polylines::read_polylines;
use crate::geometry::read::read_mesh;
use crate::geometry::{Point2, Point3, Vector3};
use crate::job::{Cuts, Job, Opening, PatternFile, Shape};
use crate::kirigami::control_mesh::{Layout, Layouts, LinearMap, Target};
use crate::kirigami::corners::four_corners;
use crate::kirigami::cover::{Boundary, Cover, ModelCell, PieceSize, grid_axis};
use crate::kirigami::feasibility::opening_of;
use crate::kirigami::levels::Level;
use crate::kirigami::pattern_mesh::{
    CutRequest, PatternMesh, PatternMeshError, Reading, cut_paths, own_cut_paths, pattern_mesh,
};
use crate::remesh::{self, SurfaceMap, align};

/// Begins with the pieces of a mesh file, which lies on the open target, or on the closed one where that is the only
/// mesh.
///
/// # Errors
/// Meshes and cuts that are no pattern, or cannot be laid flat.
pub(super) fn from_file(job: &Job, file: &PatternFile, targets: Targets) -> Result<Begun, PipelineError> {
    let scale = targets.main().scale;
    let pattern = read_pattern(file, scale)?;
    let sheet = TargetMesh {
        path: file.path.clone(),
        mesh: pattern.flatten.mesh.clone(),
        face_of: pattern.flatten.piece_of.iter().map(|&piece| pattern.source_piece[piece]).collect(),
        cycle: pattern.flatten.boundary.clone(),
        scale,
    };
    let flat = sheet.lay_flat()?;
    let on_open = targets.open.is_some();
    let side = mean_side(&pattern, &flat.points);
    let gap = job.pattern.gap;
    let cell = if on_open {
        ModelCell::from_open(side, job.pattern.stretches, gap)
    } else {
        ModelCell::from_edge(side, job.pattern.stretches, gap)
    };
    if !pattern.directions_agree && (cell.closed[0] - cell.closed[1]).abs() > 1e-9 * cell.edge() {
        return Err(PipelineError::NoDirections { path: file.path.clone() });
    }
    let (closed, open) = positions(job, &targets, &sheet, &flat.points, &cell, side)?;
    let lifted = |vertices: Vec<Point3>| {
        Layout::Lifted(LinearMap::new(TriMesh { vertices, faces: sheet.mesh.faces.clone() }, &flat.points))
    };
    let layouts = Layouts { closed: lifted(closed), open: lifted(open) };
    let cover = cover_of(&pattern, &flat.points, cell, Boundary::Glide);
    cover.check_gap(gap)?;
    // The border of the mesh, not of the target, is where the sheet ends: it may have been cut.
    let border = BoundaryCurve::new(&sheet.mesh, &sheet.cycle);
    let along = |target: TargetMesh| {
        let target = Target { surface: ClosestPoints::new(target.mesh), boundary: border };
        Aim::Surface(Box::new(target), Outline::Held)
    };
    let aims = aims(job, targets, along);
    Ok(begun(vec![Level { cover, gap }], layouts, aims, &flat))
}

/// What both states are to become; `along` makes a goal of the target that the pieces lie on.
fn aims(job: &Job, targets: Targets, along: impl FnOnce(TargetMesh) -> Aim) -> Aims {
    let unbound = if matches!(job.target.open, Shape::Free) { Aim::Free } else { Aim::Plane };
    match (targets.closed, targets.open) {
        (None, Some(open)) => Aims { closed: Aim::Plane, open: along(open) },
        (Some(closed), Some(open)) => Aims { closed: lying_in(closed), open: along(open) },
        (Some(closed), None) => Aims { closed: along(closed), open: unbound },
        (None, None) => unreachable!("the job reader asks for a mesh"),
    }
}

/// Where the vertices of a sheet, that lies on the job's main target, begin in the closed and in the open state. `flat`
/// is the sheet laid flat, `side` the mean side of its pieces there.
fn positions(
    job: &Job,
    targets: &Targets,
    sheet: &TargetMesh,
    flat: &[Point2],
    cell: &ModelCell,
    side: f64,
) -> Result<(Vec<Point3>, Vec<Point3>), PipelineError> {
    let planar = |points: &[Point2], factor: f64| -> Vec<Point3> {
        points.iter().map(|p| Point3::new(p.x * factor, p.y * factor, 0.0)).collect()
    };
    let own = sheet.mesh.vertices.clone();
    Ok(match (&targets.closed, &targets.open) {
        (None, _) if job.pattern.opening == Opening::Variable => {
            let scale = sheet.conformal_scale()?;
            let most = scale.stretches(&sheet.mesh).iter().map(|s| s.principal[0]).fold(0.0, f64::max);
            let room = 1.0 - job.pattern.gap / (2.0 * cell.edge());
            (planar(&conformal_points(&sheet.mesh, &scale), most / (MOST_OPENING * room)), own)
        }
        (None, _) => (planar(flat, cell.edge() / side), own),
        (Some(_), None) if matches!(job.target.open, Shape::Free) => {
            let larger = own.iter().map(|p| p * (cell.open[0] / side)).collect();
            (own, larger)
        }
        (Some(_), None) => (own, planar(flat, cell.open[0] / side)),
        (Some(closed), Some(open)) if targets.correspond => {
            let nearest = ClosestPoints::new(open.mesh.clone());
            (own.iter().map(|p| carried(&nearest, &closed.mesh, p)).collect(), own)
        }
        (Some(closed), Some(_)) => {
            let closed_flat = closed.lay_flat()?;
            let by = cell.closed.map(|edge| cell.open[0] / edge);
            let placed = middle_to_middle(closed, &closed_flat.points, &sheet.mesh, flat, by);
            let map = LinearMap::new(closed.mesh.clone(), &placed);
            (flat.iter().map(|p| map.apply(p)).collect(), own)
        }
    })
}

/// A closed target next to an open one: a plane, or a surface that the sheet covers a part of.
fn lying_in(closed: TargetMesh) -> Aim {
    if closed.is_planar() { Aim::Plane } else { surface(closed, Outline::Left) }
}

/// The point of `other` that corresponds with the nearest one of a mesh with the same faces.
fn carried(nearest: &ClosestPoints, other: &TriMesh, p: &Point3) -> Point3 {
    let found = nearest.closest(p);
    let corners = other.faces[found.triangle].map(|v| other.vertices[v].coords);
    Point3::from((0..3).map(|i| corners[i] * found.barycentric[i]).sum::<Vector3>())
}

fn read_pattern(file: &PatternFile, scale: f64) -> Result<PatternMesh, PipelineError> {
    let fault = |path: &Path, source: PatternMeshError| PipelineError::PatternMesh {
        path: path.to_owned(),
        source: Box::new(source),
    };
    let mut mesh = read_mesh(&file.path)?;
    mesh.vertices.iter_mut().for_each(|p| *p *= scale);
    let mut cuts = own_cut_paths(&read_polylines(&file.path)?);
    let mut request = CutRequest::AsGiven;
    match &file.cuts {
        Cuts::None => {}
        Cuts::Automatic => request = CutRequest::AutomaticToBorder,
        Cuts::File(path) => {
            let lines = read_polylines(path)?;
            cuts.extend(cut_paths(&mesh, &lines, scale).map_err(|source| fault(path, source.into()))?);
        }
    }
    pattern_mesh(&mesh, file.reading, &cuts, request).map_err(|source| {
        let of_cuts = matches!(source, PatternMeshError::Cut(_));
        match &file.cuts {
            Cuts::File(path) if of_cuts => fault(path, source),
            _ => fault(&file.path, source),
        }
    })
}

/// Mean length in the plane of the edges between two pieces. Sides along the border of a control mesh are diagonals of
/// its cells.
fn mean_side(pattern: &PatternMesh, flat: &[Point2]) -> f64 {
    let corner = |c: usize| flat[pattern.flatten.corner_vertex[c]];
    let inner = pattern.mesh.edges.iter().filter(|edge| !edge.is_border());
    let (sum, count) = inner.fold((0.0, 0.0), |(sum, count), edge| {
        let [p, q] = edge.corners.map(corner);
        (sum + (q - p).norm(), count + 1.0)
    });
    sum / count
}

/// A pattern mesh laid flat, as the stages see it.
fn cover_of(pattern: &PatternMesh, flat: &[Point2], cell: ModelCell, boundary: Boundary) -> Cover {
    let corners: Vec<Point2> = pattern.flatten.corner_vertex.iter().map(|&v| flat[v]).collect();
    let centres = pattern.flatten.centre_vertex.iter().map(|&v| flat[v]).collect();
    let places = corners.iter().map(|p| [p.x / cell.open[0], p.y / cell.open[1]]).collect();
    let mesh = pattern.mesh.clone();
    // All sides count, those along the border too.
    let sides = mesh
        .pieces
        .iter()
        .flat_map(|piece| (0..piece.len()).map(|i| [piece[i], piece[(i + 1) % piece.len()]]));
    let lengths: Vec<f64> = sides.map(|[p, q]| (corners[q] - corners[p]).norm()).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    let asked_edge = cell.edge() * mean / mean_side(pattern, flat);
    Cover { mesh, places, corners, centres, cell, asked_edge, boundary, tips: Vec::new() }
}

/// Begins with a grid along the principal directions of the map between the two states.
///
/// # Errors
/// Maps that fold, directions that no grid of the asked size follows.
pub(super) fn aligned(job: &Job, size: PieceSize, targets: Targets) -> Result<Begun, PipelineError> {
    let path = targets.main().path.clone();
    let gap = job.pattern.gap;
    let (closed, open, ratio) = states(job, &targets)?;
    let followed = job.pattern.boundary != Some(Boundary::Trimmed) && has_four_corners(targets.main())?;
    let fault = |source| PipelineError::Remesh { path: path.clone(), source };
    let map = SurfaceMap::new(closed, open).map_err(fault)?;
    let open_side = match size {
        PieceSize::Counts([nx, ny]) => (map.open().area() / (nx * ny) as f64).sqrt(),
        PieceSize::Edge(edge) => edge * (map.open().area() / map.closed().area()).sqrt(),
    };
    let outline = if followed { remesh::Outline::Followed } else { remesh::Outline::Trimmed };
    let shape = if job.pattern.opening == Opening::Variable { cell_shape(&map) } else { 1.0 };
    let cell = [open_side / shape.sqrt(), open_side * shape.sqrt()];
    let options = remesh::Options { cell, outline, ..remesh::Options::square(open_side) };
    let aligned = align(&map, &options).map_err(fault)?;
    let pattern = pattern_mesh(&aligned.mesh, Reading::Pieces, &[], CutRequest::AsGiven)
        .map_err(|source| PipelineError::PatternMesh { path: path.clone(), source: Box::new(source) })?;
    let vertices = |of: &[Point3]| flatten_vertices(&pattern, of);
    let (closed_at, open_at) = (vertices(&aligned.closed), vertices(&aligned.mesh.vertices));
    let flat = plane_of(&pattern, &closed_at, &open_at, &path)?;
    let closed_mesh = |vertices| PolyMesh { vertices, faces: pattern.mesh.pieces.clone() };
    let corner_points =
        |at: &[Point3]| pattern.flatten.corner_vertex.iter().map(|&v| at[v]).collect::<Vec<_>>();
    let cell = ModelCell {
        open: [mean_edge(&closed_mesh(corner_points(&open_at))); 2],
        closed: [mean_edge(&closed_mesh(corner_points(&closed_at))); 2],
    };
    let boundary = if followed { Boundary::Glide } else { Boundary::Trimmed };
    let cover = cover_of(&pattern, &flat, cell, boundary);
    cover.check_gap(gap)?;
    let lifted = |vertices| {
        let faces = pattern.flatten.mesh.faces.clone();
        Layout::Lifted(LinearMap::new(TriMesh { vertices, faces }, &flat))
    };
    let layouts = Layouts { closed: lifted(closed_at), open: lifted(open_at) };
    let aims = aims(job, targets, |target| surface(target, Outline::Held));
    Ok(Begun { levels: vec![Level { cover, gap }], layouts, aims, ratio, reports: Vec::new() })
}

/// Side across the larger stretch over the side along it, of the open cells of rectangles that give the map's stretches
/// in the mean: with sides a and b = r a their open cells are m1 a by m2 r a (section 2.2 of the model). 1 where no
/// rectangle does.
fn cell_shape(map: &SurfaceMap) -> f64 {
    let (mut sums, mut total) = ([0.0, 0.0], 0.0);
    for (principal, face) in map.principal().iter().zip(&map.closed().faces) {
        let [a, b, c] = face.map(|v| map.closed().vertices[v]);
        let area = (b - a).cross(&(c - a)).norm();
        sums = [0, 1].map(|i| sums[i] + area * principal.stretches[i].ln());
        total += area;
    }
    let [m1, m2] = sums.map(|sum| (sum / total).exp());
    opening_of([m1, m2]).map_or(1.0, |(_, r)| r * m2 / m1)
}

/// Whether the outline of a target has four corners.
fn has_four_corners(target: &TargetMesh) -> Result<bool, PipelineError> {
    let flat = target.lay_flat()?;
    let outline = target.outline(&flat.points);
    let first = first_axis(&target.mesh, &flat.points);
    Ok(four_corners(&outline, &grid_axis(&outline, &first)).is_some())
}

/// The target in both states as Stage 1 has it, and the ratio of its conformal flattening.
fn states(job: &Job, targets: &Targets) -> Result<(TriMesh, TriMesh, f64), PipelineError> {
    let planar = |target: &TargetMesh, points: &[Point2], factor: f64| TriMesh {
        vertices: points.iter().map(|p| Point3::new(p.x * factor, p.y * factor, 0.0)).collect(),
        faces: target.mesh.faces.clone(),
    };
    match (&targets.closed, &targets.open) {
        (None, Some(open)) if job.pattern.opening == Opening::Variable => {
            let scale = open.conformal_scale()?;
            let most = scale.stretches(&open.mesh).iter().map(|s| s.principal[0]).fold(0.0, f64::max);
            let closed = planar(open, &conformal_points(&open.mesh, &scale), most / MOST_OPENING);
            Ok((closed, open.mesh.clone(), scale.ratio()))
        }
        (None, Some(open)) => {
            let flat = open.lay_flat()?;
            Ok((planar(open, &flat.points, std::f64::consts::FRAC_1_SQRT_2), open.mesh.clone(), flat.ratio))
        }
        (Some(closed), None) => {
            let flat = closed.lay_flat()?;
            let mut open = planar(closed, &flat.points, std::f64::consts::SQRT_2);
            if matches!(job.target.open, Shape::Free) {
                open.vertices = closed.mesh.vertices.iter().map(|p| p * std::f64::consts::SQRT_2).collect();
            }
            Ok((closed.mesh.clone(), open, flat.ratio))
        }
        (Some(closed), Some(open)) if targets.correspond => {
            let flat = closed.lay_flat()?;
            // A planar closed mesh is a sheet in the plane z = 0.
            let sheet =
                if closed.is_planar() { planar(closed, &flat.points, 1.0) } else { closed.mesh.clone() };
            Ok((sheet, open.mesh.clone(), flat.ratio))
        }
        (Some(closed), Some(_)) => Err(PipelineError::NoMap { path: closed.path.clone() }),
        (None, None) => unreachable!("the job reader asks for a mesh"),
    }
}

/// Positions of the vertices of the surface that Stage 1 flattens, from those of the source's.
fn flatten_vertices(pattern: &PatternMesh, of: &[Point3]) -> Vec<Point3> {
    let mut at = vec![Point3::origin(); pattern.flatten.mesh.vertices.len()];
    for (&vertex, &source) in pattern.flatten.corner_vertex.iter().zip(&pattern.source_vertex) {
        at[vertex] = of[source];
    }
    for (&vertex, piece) in pattern.flatten.centre_vertex.iter().zip(&pattern.mesh.pieces) {
        let sum: Vector3 = piece.iter().map(|&c| of[pattern.source_vertex[c]].coords).sum();
        at[vertex] = Point3::from(sum / piece.len() as f64);
    }
    at
}

/// The pieces in a plane: in the state that lies in it, else laid flat.
fn plane_of(
    pattern: &PatternMesh,
    closed: &[Point3],
    open: &[Point3],
    path: &Path,
) -> Result<Vec<Point2>, PipelineError> {
    for state in [closed, open] {
        if state.iter().all(|p| p.z == 0.0) {
            return Ok(state.iter().map(|p| p.xy()).collect());
        }
    }
    let sheet = TargetMesh {
        path: path.to_owned(),
        mesh: TriMesh { vertices: open.to_vec(), faces: pattern.flatten.mesh.faces.clone() },
        face_of: pattern.flatten.piece_of.clone(),
        cycle: pattern.flatten.boundary.clone(),
        scale: 1.0,
    };
    Ok(sheet.lay_flat()?.points)
}

/// Mean length of the sides of the faces.
fn mean_edge(mesh: &PolyMesh) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for face in &mesh.faces {
        for (i, &v) in face.iter().enumerate() {
            sum += (mesh.vertices[face[(i + 1) % face.len()]] - mesh.vertices[v]).norm();
            count += 1.0;
        }
    }
    sum / count
}
