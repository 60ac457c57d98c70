//! The target meshes: read, checked, scaled, and laid flat.

use std::path::{Path, PathBuf};

use super::error::PipelineError;
use crate::geometry::flatten::{ConformalScale, FlattenError, Flattening, flatten};
use crate::geometry::mesh::{PolyMesh, TriMesh};
use crate::geometry::read::read_mesh;
use crate::geometry::topology::check_disk;
use crate::geometry::triangulate::{Surface, triangulate, triangulate_from_centres};
use crate::geometry::{Point2, Vector2, Vector3, bounds};
use crate::job::{self, Shape};
use crate::kirigami::feasibility::{EASY_RATIO, MOST_STRETCH_RATIO};

/// A target mesh, millimetres.
pub(super) struct TargetMesh {
    /// Its file.
    pub path: PathBuf,
    /// Millimetres per unit of the file.
    pub scale: f64,
    /// The triangulated surface, a disk.
    pub mesh: TriMesh,
    /// The face of the file, counted from 0, that each triangle is part of.
    pub face_of: Vec<usize>,
    /// The boundary loop, the surface on the left.
    pub cycle: Vec<usize>,
}

/// The meshes that a job names.
pub(super) struct Targets {
    pub closed: Option<TargetMesh>,
    pub open: Option<TargetMesh>,
    /// Whether both have the same faces, so that their vertices correspond.
    pub correspond: bool,
}

impl Targets {
    /// The open target, else the closed one: the one that the job's size is meant for.
    pub fn main(&self) -> &TargetMesh {
        self.open.as_ref().or(self.closed.as_ref()).expect("the job reader asks for a mesh")
    }
}

/// Reads the targets of a job, checks that they are disks, and those of a map that they do not fold, and scales them to
/// millimetres.
pub(super) fn read_targets(target: &job::Target) -> Result<Targets, PipelineError> {
    let (open, closed) = (read_shape(&target.open)?, read_shape(&target.closed)?);
    let extent = |mesh: &PolyMesh| {
        let (low, high) = bounds(mesh.faces.iter().flatten().map(|&v| &mesh.vertices[v]));
        (high - low).max()
    };
    let main = open.as_ref().or(closed.as_ref()).map(|(_, mesh)| extent(mesh));
    let scale = match (target.size, main) {
        (Some(size), Some(extent)) => size / extent,
        _ => target.units.millimetres(),
    };
    let closed_scale = |mesh: &PolyMesh| target.closed_size.map_or(scale, |size| size / extent(mesh));
    let alike = matches!((&open, &closed), (Some((_, a)), Some((_, b))) if a.faces == b.faces);
    let split = if alike { triangulate_from_centres } else { triangulate };
    let prepare = |path: &Path, mesh: PolyMesh, scale: f64| {
        let disk =
            check_disk(&mesh).map_err(|source| PipelineError::Topology { path: path.to_owned(), source })?;
        let surface = split(&mesh, scale)
            .map_err(|source| PipelineError::Triangulate { path: path.to_owned(), source })?;
        // Splitting faces leaves the boundary as it is; only the numbers of its vertices change, and these ascend.
        let number =
            |vertex: &usize| surface.vertex_of.binary_search(vertex).expect("boundary vertices are used");
        let cycle = disk.boundary.iter().map(number).collect();
        let Surface { mesh, face_of, .. } = surface;
        Ok::<_, PipelineError>(TargetMesh { path: path.to_owned(), mesh, face_of, cycle, scale })
    };
    let targets = Targets {
        closed: match closed {
            Some((path, mesh)) => Some(prepare(path, mesh.clone(), closed_scale(&mesh))?),
            None => None,
        },
        open: open.map(|(path, mesh)| prepare(path, mesh, scale)).transpose()?,
        correspond: alike,
    };
    if alike {
        for target in targets.closed.iter().chain(&targets.open) {
            target.unfolded()?;
        }
    }
    Ok(targets)
}

fn read_shape(shape: &Shape) -> Result<Option<(&Path, PolyMesh)>, PipelineError> {
    match shape {
        Shape::Mesh(path) => Ok(Some((path, read_mesh(path)?))),
        Shape::Flat | Shape::Free => Ok(None),
    }
}

/// A target laid flat, with what is to be told about it.
pub(super) struct LaidFlat {
    /// #V points of the plane.
    pub points: Vec<Point2>,
    /// How the map was found.
    pub flattening: Flattening,
    /// Largest over smallest scale of the conformal flattening.
    pub ratio: f64,
}

impl TargetMesh {
    /// Whether all vertices lie in one plane, up to rounding of the file's coordinates.
    pub fn is_planar(&self) -> bool {
        let (low, high) = bounds(&self.mesh.vertices);
        let middle = crate::geometry::centroid(&self.mesh.vertices);
        let scatter: nalgebra::Matrix3<f64> =
            self.mesh.vertices.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
        let eigen = scatter.symmetric_eigen();
        let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        let off = self.mesh.vertices.iter().map(|p| (p - middle).dot(&normal).abs()).fold(0.0, f64::max);
        // Six digits are what mesh files usually carry.
        off <= 1e-6 * (high - low).norm()
    }

    /// That no triangle of a map's mesh is turned over against those around it.
    fn unfolded(&self) -> Result<(), PipelineError> {
        let area = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|v| self.mesh.vertices[v]);
            (b - a).cross(&(c - a))
        };
        let mut around = vec![Vector3::zeros(); self.mesh.vertices.len()];
        for face in &self.mesh.faces {
            face.iter().for_each(|&v| around[v] += area(face));
        }
        // The triangle itself counts at all its three vertices.
        let folded = |face: &[usize; 3]| {
            let own = area(face);
            own.dot(&(face.iter().map(|&v| around[v]).sum::<Vector3>() - 3.0 * own)) < 0.0
        };
        match self.mesh.faces.iter().position(folded) {
            None => Ok(()),
            Some(triangle) => Err(PipelineError::FoldedMap {
                path: self.path.clone(),
                face: self.face_of[triangle] + 1,
                at: self.mesh.vertices[self.mesh.faces[triangle][0]],
            }),
        }
    }

    /// Lays the mesh flat, as rigidly as possible and with bounded stretch.
    ///
    /// # Errors
    /// A target that curves too much, or folds over.
    pub fn lay_flat(&self) -> Result<LaidFlat, PipelineError> {
        let scale = self.conformal_scale()?;
        let ratio = scale.ratio();
        let flattening =
            flatten(&self.mesh, &scale, EASY_RATIO).map_err(|error| self.flatten_error(error))?;
        Ok(LaidFlat { points: flattening.points.clone(), flattening, ratio })
    }

    /// The scales of the conformal flattening.
    ///
    /// # Errors
    /// A target that curves too much.
    pub fn conformal_scale(&self) -> Result<ConformalScale, PipelineError> {
        let scale =
            ConformalScale::solve(&self.mesh, &self.cycle).map_err(|error| self.flatten_error(error))?;
        let ratio = scale.ratio();
        if ratio.is_nan() || ratio > MOST_STRETCH_RATIO {
            let at = self.mesh.vertices[scale.most_scaled()];
            return Err(PipelineError::Stretch { path: self.path.clone(), ratio, at });
        }
        Ok(scale)
    }

    /// A flattening's error, with the file and its face.
    pub fn flatten_error(&self, source: FlattenError) -> PipelineError {
        match source {
            // Faces are counted from 1, as OBJ files do.
            FlattenError::Folded { triangle, ratio } => PipelineError::Folded {
                path: self.path.clone(),
                face: self.face_of[triangle] + 1,
                at: self.mesh.vertices[self.mesh.faces[triangle][0]],
                ratio,
            },
            source => PipelineError::Flatten { path: self.path.clone(), source },
        }
    }

    /// The boundary in a flattening.
    pub fn outline(&self, flat: &[Point2]) -> Vec<Point2> {
        self.cycle.iter().map(|&v| flat[v]).collect()
    }
}

/// The direction in the flattening that comes nearest to the target's x axis (y, where the target has no
/// extent in x): the mean gradient of that coordinate.
pub(super) fn first_axis(mesh: &TriMesh, flat: &[Point2]) -> Vector2 {
    let mut sums = [Vector2::zeros(), Vector2::zeros()];
    let mut total = 0.0;
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| flat[v]);
        let (ab, ac) = (b - a, c - a);
        total += ab.perp(&ac);
        for (axis, sum) in sums.iter_mut().enumerate() {
            let [fa, fb, fc] = face.map(|v| mesh.vertices[v][axis]);
            // Twice the area times the gradient of the linear function through the three values.
            *sum += Vector2::new(ac.y, -ac.x) * (fb - fa) + Vector2::new(-ab.y, ab.x) * (fc - fa);
        }
    }
    // A tenth: below it x says little about directions on the surface.
    if sums[0].norm() > 0.1 * total.abs() {
        sums[0].normalize()
    } else {
        sums[1].try_normalize(0.0).unwrap_or(Vector2::x())
    }
}
