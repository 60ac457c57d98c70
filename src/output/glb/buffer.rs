//! The numbers of a glTF file: three runs of bytes, and accessors into them.

use serde_json::{Value, json};

/// What the numbers of an animation are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Times.
    Scalar,
    /// Places.
    Vector,
    /// Rotations.
    Quaternion,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Scalar => "SCALAR",
            Self::Vector => "VEC3",
            Self::Quaternion => "VEC4",
        }
    }
}

const FLOAT: u32 = 5126;
const SHORT: u32 = 5123;
const LONG: u32 = 5125;
const ARRAY: u32 = 34962;
const ELEMENTS: u32 = 34963;

/// Most vertices whose indices fit in two bytes; the largest number has a meaning of its own.
const MOST_SHORT: usize = 65535;

/// Being filled.
#[derive(Debug, Default)]
pub struct Buffer {
    positions: Vec<u8>,
    indices: Vec<u8>,
    motions: Vec<u8>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds vertices; their accessor.
    pub fn positions(&mut self, points: &[[f32; 3]]) -> usize {
        let [low, high] = bounds(points);
        self.accessors.push(json!({
            "bufferView": 0, "byteOffset": self.positions.len(), "componentType": FLOAT, "count": points.len(),
            "type": "VEC3", "min": low, "max": high,
        }));
        self.positions.extend(points.iter().flatten().flat_map(|c| c.to_le_bytes()));
        self.accessors.len() - 1
    }

    /// Adds triangles over so many vertices; their accessor.
    pub fn indices(&mut self, faces: &[[usize; 3]], vertices: usize) -> usize {
        let short = vertices <= MOST_SHORT;
        if !short {
            self.indices.resize(self.indices.len().next_multiple_of(4), 0);
        }
        self.accessors.push(json!({
            "bufferView": 1, "byteOffset": self.indices.len(), "componentType": if short { SHORT } else { LONG },
            "count": 3 * faces.len(), "type": "SCALAR",
        }));
        for &index in faces.iter().flatten() {
            match short {
                true => self.indices.extend((index as u16).to_le_bytes()),
                false => self.indices.extend((index as u32).to_le_bytes()),
            }
        }
        self.accessors.len() - 1
    }

    /// Adds numbers of an animation; their accessor. Times need their `bounds`.
    pub fn motion<const N: usize>(&mut self, kind: Kind, values: &[[f32; N]], bounded: bool) -> usize {
        let mut accessor = json!({
            "bufferView": 2, "byteOffset": self.motions.len(), "componentType": FLOAT, "count": values.len(),
            "type": kind.name(),
        });
        if bounded {
            let [low, high] = bounds(values);
            accessor["min"] = json!(low);
            accessor["max"] = json!(high);
        }
        self.accessors.push(accessor);
        self.motions.extend(values.iter().flatten().flat_map(|c| c.to_le_bytes()));
        self.accessors.len() - 1
    }

    /// Views, accessors and all bytes, a multiple of four of them.
    pub fn finish(self) -> (Vec<Value>, Vec<Value>, Vec<u8>) {
        let mut bytes = Vec::new();
        let mut view = |part: &[u8]| {
            let view = json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": part.len() });
            bytes.extend(part);
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            view
        };
        let mut views = vec![view(&self.positions), view(&self.indices), view(&self.motions)];
        views[0]["byteStride"] = json!(12);
        views[0]["target"] = json!(ARRAY);
        views[1]["target"] = json!(ELEMENTS);
        (views, self.accessors, bytes)
    }
}

/// Least and largest of each component.
fn bounds<const N: usize>(points: &[[f32; N]]) -> [Vec<f32>; 2] {
    let (mut low, mut high) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
    for point in points {
        low = std::array::from_fn(|k| low[k].min(point[k]));
        high = std::array::from_fn(|k| high[k].max(point[k]));
    }
    [low.to_vec(), high.to_vec()]
}
