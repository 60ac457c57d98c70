//! The morph as glTF 2.0 in one binary file: thick pieces, one node each, with an animation from the closed to the open state.
//!
//! glTF has metres and y up. A point (x, y, z) mm of the design stands at (x, z, -y) / 1000: the sheet lies on the floor, its
//! upper side up. Every piece's node turns about the middle of its hinge points; at rest it is in the sheet state (closed,
//! where neither is flat), and the animation "open" begins in the closed one. A hinge's axis is a thin red prism, a child of
//! the first of its two pieces.
//!
//! Faces have no normals: readers shade them flat, as the specification asks.

mod buffer;

use std::io::{self, Write};

use nalgebra::{Rotation3, UnitQuaternion};
use serde_json::{Value, json};

use self::buffer::{Buffer, Kind};
use super::preview::opening::senses;
use super::preview::page::Sense;
use crate::fabrication::states::sheet_vertices;
use crate::geometry::mesh::TriMesh;
use crate::geometry::plane::doubled_area;
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::Design;
use crate::morph::Morph;

/// What the file shows.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// Name of the job.
    pub name: &'a str,
    /// The design.
    pub design: &'a Design,
    /// The solid of every piece, millimetres, in the sheet state (closed, where neither is flat).
    pub bodies: &'a [TriMesh],
    /// How they move.
    pub morph: &'a Morph,
}

/// How long the animation takes, seconds.
const DURATION: f32 = 6.0;
/// Length and thickness (radius) of an axis, in mean edges.
const AXIS: [f64; 2] = [0.8, 0.012];
const RED: [f64; 3] = [210.0, 20.0, 20.0];

/// Writes the scene; the same scene gives the same bytes.
///
/// # Errors
/// The error of `out`, or a scene beyond the four gigabytes that the format has room for.
pub fn write<W: Write>(scene: &Scene, mut out: W) -> io::Result<()> {
    let mut buffer = Buffer::default();
    let materials = Materials::new(scene.design);
    let centres: Vec<Point3> =
        scene.design.pieces.iter().map(|piece| centroid(sheet_vertices(scene.design, piece))).collect();
    let mut meshes: Vec<Value> = Vec::new();
    for ((body, centre), material) in scene.bodies.iter().zip(&centres).zip(&materials.of_piece) {
        let vertices: Vec<[f32; 3]> = body.vertices.iter().map(|p| metres(&(p - centre))).collect();
        meshes.push(mesh(&mut buffer, &vertices, &body.faces, *material));
    }
    let (vertices, faces) = prism();
    meshes.push(mesh(&mut buffer, &vertices, &faces, materials.all.len() - 1));
    let animation = animation(scene, &centres, &mut buffer);
    let (views, accessors, bytes) = buffer.finish();
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("kirimorph ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "name": scene.name, "nodes": [0] }],
        "nodes": nodes(scene, &centres),
        "meshes": meshes,
        "materials": materials.all,
        "animations": [animation],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len() }],
    });
    let mut text = serde_json::to_vec(&document)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let too_large = |_| io::Error::other("the morph is too large for a .glb file: four gigabytes");
    let length = |count: usize| u32::try_from(count).map_err(too_large);
    out.write_all(b"glTF")?;
    for number in [2, length(12 + 8 + text.len() + 8 + bytes.len())?, length(text.len())?] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&length(bytes.len())?.to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(&bytes)?;
    out.flush()
}

/// A vector of the design, millimetres, in glTF's metres with y up.
fn metres(v: &Vector3) -> [f32; 3] {
    // Plus nothing: no negative zeros.
    up(v).map(|c| (1e-3 * c + 0.0) as f32)
}

/// A vector of the design in glTF's directions.
fn up(v: &Vector3) -> [f64; 3] {
    [v.x, v.z, -v.y]
}

/// A rotation of the design in glTF's directions: x, y, z, w.
fn quaternion(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    let [x, y, z] = up(&rotation.imag());
    [x, y, z, rotation.w]
}

/// The materials in use, and those of the pieces.
struct Materials {
    /// That of the axes comes last.
    all: Vec<Value>,
    of_piece: Vec<usize>,
}

impl Materials {
    fn new(design: &Design) -> Self {
        let normal =
            |piece| doubled_area(sheet_vertices(design, piece)).try_normalize(0.0).unwrap_or_default();
        let normals: Vec<Vector3> = design.pieces.iter().map(normal).collect();
        let senses = senses(design, &normals);
        let names = [
            (Sense::CounterClockwise, "turns counter-clockwise"),
            (Sense::Clockwise, "turns clockwise"),
            (Sense::Still, "does not turn"),
        ];
        let used: Vec<_> = names.into_iter().filter(|(sense, _)| senses.contains(sense)).collect();
        let mut all: Vec<Value> = used.iter().map(|(sense, name)| material(name, sense.tone())).collect();
        all.push(material("hinge axes", RED));
        let number = |sense: &Sense| used.iter().position(|(other, _)| other == sense).unwrap_or(0);
        Self { all, of_piece: senses.iter().map(number).collect() }
    }
}

/// A dull material of an sRGB colour, of 255.
fn material(name: &str, colour: [f64; 3]) -> Value {
    // IEC 61966-2-1; glTF's factors are linear.
    let linear = |c: f64| (((c / 255.0 + 0.055) / 1.055).powf(2.4) * 1e4).round() / 1e4;
    let [r, g, b] = colour.map(linear);
    json!({
        "name": name,
        "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 },
    })
}

fn mesh(buffer: &mut Buffer, vertices: &[[f32; 3]], faces: &[[usize; 3]], material: usize) -> Value {
    let (positions, indices) = (buffer.positions(vertices), buffer.indices(faces, vertices.len()));
    json!({ "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices, "material": material }] })
}

/// A three-sided prism along y, of length and radius 1.
fn prism() -> (Vec<[f32; 3]>, Vec<[usize; 3]>) {
    const CORNERS: [[f32; 2]; 3] = [[1.0, 0.0], [-0.5, -0.866], [-0.5, 0.866]];
    let at = |height: f32| CORNERS.map(|[x, z]| [x, height, z]);
    let mut faces = vec![[0, 2, 1], [3, 4, 5]];
    for [i, j] in [[0, 1], [1, 2], [2, 0]] {
        faces.extend([[i, j, j + 3], [i, j + 3, i + 3]]);
    }
    ([at(-0.5), at(0.5)].concat(), faces)
}

/// The sheet, then the pieces, then the axes.
fn nodes(scene: &Scene, centres: &[Point3]) -> Vec<Value> {
    let Scene { name, design, .. } = scene;
    let count = centres.len();
    let mut axes: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (id, hinge) in design.hinges.iter().enumerate() {
        axes[hinge.pieces[0]].push(1 + count + id);
    }
    let mut nodes = vec![json!({ "name": name, "children": (1..=count).collect::<Vec<_>>() })];
    for (piece, (centre, axes)) in centres.iter().zip(axes).enumerate() {
        let place = rounded(up(&(1e-3 * centre.coords)));
        let mut node = json!({ "name": format!("piece {piece}"), "mesh": piece, "translation": place });
        if !axes.is_empty() {
            node["children"] = json!(axes);
        }
        nodes.push(node);
    }
    let [length, radius] = AXIS.map(|part| part * design.mean_edge() * 1e-3);
    for (id, hinge) in design.hinges.iter().enumerate() {
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &hinge.axis);
        let turn =
            turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let arm = hinge.point - centres[hinge.pieces[0]];
        nodes.push(json!({
            "name": format!("hinge {id}"),
            "mesh": count,
            "translation": rounded(up(&(1e-3 * arm))),
            "rotation": rounded(quaternion(&turn)),
            "scale": rounded([radius, length, radius]),
        }));
    }
    nodes
}

/// To a millionth of a millimetre, which keeps the text short.
fn rounded<const N: usize>(values: [f64; N]) -> [f64; N] {
    values.map(|value| (value * 1e9).round() / 1e9 + 0.0)
}

/// The animation: for each piece where its middle goes and how it turns.
fn animation(scene: &Scene, centres: &[Point3], buffer: &mut Buffer) -> Value {
    let Scene { morph, .. } = scene;
    let times: Vec<[f32; 1]> = morph.steps.iter().map(|step| [DURATION * step.at as f32]).collect();
    let input = buffer.motion(Kind::Scalar, &times, true);
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for (piece, centre) in centres.iter().enumerate() {
        let poses = || morph.steps.iter().map(|step| &step.poses[piece]);
        let places: Vec<[f32; 3]> = poses().map(|pose| metres(&pose.apply(centre).coords)).collect();
        let outputs = [
            ("translation", buffer.motion(Kind::Vector, &places, false)),
            ("rotation", buffer.motion(Kind::Quaternion, &turns(poses()), false)),
        ];
        for (path, output) in outputs {
            channels
                .push(json!({ "sampler": samplers.len(), "target": { "node": 1 + piece, "path": path } }));
            samplers.push(json!({ "input": input, "output": output }));
        }
    }
    json!({ "name": "open", "samplers": samplers, "channels": channels })
}

/// The rotations of a piece, each by the shorter way from the one before.
fn turns<'a>(poses: impl Iterator<Item = &'a RigidMotion>) -> Vec<[f32; 4]> {
    let mut before = [0.0, 0.0, 0.0, 1.0];
    let mut turn = |pose: &RigidMotion| {
        let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
        let mut now = quaternion(&UnitQuaternion::from_rotation_matrix(&rotation));
        if now.iter().zip(&before).map(|(a, b)| a * b).sum::<f64>() < 0.0 {
            now = now.map(|c| -c);
        }
        before = now;
        now.map(|c| (c + 0.0) as f32)
    };
    poses.map(&mut turn).collect()
}
