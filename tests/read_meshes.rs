//! Meshes from files: hostile content, and meshes that others made.

mod sound;

use std::fs;
use std::path::{Path, PathBuf};

use kirimorph::geometry::mesh::PolyMesh;
use kirimorph::geometry::read::{MAX_FILE_BYTES, MeshFormat, ReadMeshError, parse_mesh, read_mesh};
use kirimorph::geometry::topology::{Defect, check_disk, disk};
use kirimorph::geometry::triangulate::triangulate;
use sound::assert_sound;

/// A folder of its own for the files of one test, removed at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn file(&self, name: &str, content: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, content).unwrap();
        path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const OBJ: &str =
    "# dart\nv 0 0 0\nv 2 0 0.5\nv 2 2 0\nv 0.5 1 -1e-3\nv 9 9 9\nf 1/1/1 2//2 3/3 4\nf -5 -3 \\\n-4\n";

const ASCII_STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 -2.5e-1\n\
    endloop\nendfacet\nendsolid a\nSOLID\nfacet normal 0 0 1\nouter loop\nvertex 0 1 -0.25\nvertex 1 0 0\n\
    vertex 1 1 0\nendloop\nendfacet\nendsolid\n";

const ASCII_PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\n\
    property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 1\n1 0 0 2\n1 1 0.5 3\n0 1 0 4\n3 0 1 2\n3 0 2 3\n";

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2_u32.to_le_bytes());
    for corners in
        [[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5], [0.0, 1.0, 0.5, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0]]
    {
        bytes.extend([0.0_f32, 0.0, 1.0].into_iter().chain(corners).flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

fn binary_ply() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty short y\n\
        property float z\nproperty list uchar char extra\nelement face 1\nproperty list int ushort vertex_index\n\
        end_header\n"
        .to_vec();
    for (x, y) in [(0.0_f32, 0_i16), (1.0, 0), (0.0, 1)] {
        bytes.extend(x.to_be_bytes());
        bytes.extend(y.to_be_bytes());
        bytes.extend(0.25_f32.to_be_bytes());
        bytes.extend([1, 7]);
    }
    bytes.extend(3_i32.to_be_bytes());
    bytes.extend([0, 0, 0, 1, 0, 2]);
    bytes
}

#[test]
fn the_ending_tells_the_format() {
    let scratch = Scratch::new("endings");
    for (name, content) in [
        ("a.obj", OBJ.as_bytes()),
        ("b.OBJ", OBJ.as_bytes()),
        ("c.Stl", ASCII_STL.as_bytes()),
        ("d.stl", &binary_stl()),
        ("e.d.PLY", ASCII_PLY.as_bytes()),
        ("f ü.ply", &binary_ply()),
    ] {
        assert_sound(&read_mesh(&scratch.file(name, content)).unwrap());
    }
    for name in ["a.off", "obj", ".obj", "a.obj.gz"] {
        let error = read_mesh(&scratch.file(name, OBJ.as_bytes())).unwrap_err();
        assert!(matches!(error, ReadMeshError::UnknownFormat { .. }), "{name}: {error}");
    }
}

#[test]
fn files_that_cannot_be_meshes_are_refused_by_name() {
    let scratch = Scratch::new("refused");
    let folder = scratch.0.join("folder.obj");
    fs::create_dir(&folder).unwrap();
    let message = |path: &Path| {
        let message = read_mesh(path).unwrap_err().to_string();
        assert!(message.starts_with(path.to_str().unwrap()), "{message}");
        message[path.to_str().unwrap().len() + 2..].to_owned()
    };
    assert_eq!(message(&folder), "is a folder, not a mesh file");
    assert!(message(&scratch.0.join("missing.stl")).starts_with("cannot be read: "));
    for format in ["obj", "stl", "ply"] {
        assert!(message(&scratch.file(&format!("empty.{format}"), b"")).starts_with("the file is empty"));
        assert!(
            message(&scratch.file(&format!("blank.{format}"), b" \r\n\t\n")).starts_with("the file is empty")
        );
        let zeros = scratch.file(&format!("zeros.{format}"), &[0; 1000]);
        assert!(matches!(read_mesh(&zeros), Err(ReadMeshError::Invalid { .. })));
    }
    let invalid = scratch.file("line.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    assert_eq!(message(&invalid), "line 4: vertex 4 is named, but the vertices run from 1 to 3");
}

#[test]
fn a_file_beyond_the_size_limit_is_refused() {
    let scratch = Scratch::new("large");
    let path = scratch.file("large.obj", b"");
    // A sparse file: its bytes take no room on the disk.
    fs::File::options().write(true).open(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
    assert!(matches!(read_mesh(&path), Err(ReadMeshError::TooLarge { .. })));
}

#[test]
fn what_stl_io_writes_is_read() {
    let obj = parse_mesh(OBJ.as_bytes(), MeshFormat::Obj).unwrap();
    let surface = triangulate(&obj, 1.0).unwrap();
    let corner = |v: usize| {
        let p = surface.mesh.vertices[v];
        stl_io::Vertex::new([p.x as f32, p.y as f32, p.z as f32])
    };
    let triangles: Vec<stl_io::Triangle> = surface
        .mesh
        .faces
        .iter()
        .map(|face| stl_io::Triangle { normal: stl_io::Normal::new([0.0; 3]), vertices: face.map(corner) })
        .collect();
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter()).unwrap();
    let read = parse_mesh(&bytes, MeshFormat::Stl).unwrap();
    assert_eq!(read.faces.len(), surface.mesh.faces.len());
    assert_eq!(read.vertices.len(), surface.mesh.vertices.len());
    for (face, original) in read.faces.iter().zip(&surface.mesh.faces) {
        for (&v, &w) in face.iter().zip(original) {
            // Rounded to f32 on the way.
            assert!((read.vertices[v] - surface.mesh.vertices[w]).norm() < 1e-6);
        }
    }
}

/// The folder of meshes that nobody on the project made; it lies beside the repository.
fn shared_meshes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{} is missing", folder.display());
    println!("skipped: {} is missing", folder.display());
    None
}

/// Name, vertices, faces of the disks, as listed in the folder's ORIGIN.md.
const DISKS: [(&str, usize, usize); 9] = [
    ("M2_eq_quad2", 920, 871),
    ("6-sub-lifted", 209, 188),
    ("pillow_1", 1369, 1296),
    ("choi_paraboloid", 441, 800),
    ("conical1", 1147, 1080),
    ("hemisphere", 2051, 4000),
    ("helical-minimal", 441, 400),
    ("choi_peaks", 441, 800),
    ("face", 17157, 34144),
];

#[test]
fn real_disks_are_read_and_accepted() {
    let Some(folder) = shared_meshes() else { return };
    for (name, vertices, faces) in DISKS {
        let mesh = read_mesh(&folder.join(name).with_extension("obj")).unwrap();
        assert_sound(&mesh);
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (vertices, faces), "{name}");
        let boundary = check_disk(&mesh).unwrap_or_else(|error| panic!("{name}: {error}")).boundary;

        let surface = triangulate(&mesh, 2.5).unwrap_or_else(|error| panic!("{name}: {error}"));
        // A face of n corners gives n - 2 triangles, and two more where it is warped and split from a centre.
        let corners: usize = mesh.faces.iter().map(|face| face.len() - 2).sum();
        let centres = surface.mesh.vertices.len() - surface.vertex_of.len();
        assert_eq!(surface.mesh.faces.len(), corners + 2 * centres, "{name}");
        // Splitting faces leaves the boundary as it is.
        let split: Vec<usize> =
            disk(&surface.mesh.faces).unwrap().boundary.iter().map(|&v| surface.vertex_of[v]).collect();
        assert_eq!(split, boundary, "{name}");
        // Euler: the triangles of a disk number 2 V - 2 - boundary vertices.
        assert_eq!(surface.mesh.faces.len() + 2 + boundary.len(), 2 * surface.mesh.vertices.len(), "{name}");
    }
}

#[test]
fn real_meshes_that_are_no_disks_are_told_by_name() {
    let Some(folder) = shared_meshes() else { return };
    let annulus = read_mesh(&folder.join("cmc1.obj")).unwrap();
    let error = check_disk(&annulus).unwrap_err();
    assert!(error.to_string().starts_with("the mesh is an annulus with 2 boundary loops"), "{error}");

    let sphere = read_mesh(&folder.join("choi_sphere.obj")).unwrap();
    assert_eq!((sphere.vertices.len(), sphere.faces.len()), (642, 1280));
    let error = check_disk(&sphere).unwrap_err();
    assert_eq!(error.defect, Defect::Closed { genus: 0 });
    assert!(error.to_string().contains("cut it open"), "{error}");
}

#[test]
fn damage_to_a_real_mesh_is_found() {
    let Some(folder) = shared_meshes() else { return };
    let mesh = read_mesh(&folder.join("pillow_1.obj")).unwrap();
    // A grid of 36 x 36 quads: row 18, column 18.
    let middle = 18 * 36 + 18;
    let defect = |change: &dyn Fn(&mut PolyMesh)| {
        let mut changed = mesh.clone();
        change(&mut changed);
        check_disk(&changed).unwrap_err().defect
    };
    let turned = defect(&|m| m.faces[middle].reverse());
    assert!(
        matches!(turned, Defect::Winding { more: 3, faces, .. } if faces.contains(&middle)),
        "{turned:?}"
    );
    assert!(matches!(defect(&|m| drop(m.faces.remove(middle))), Defect::Holes { loops } if loops[1] == 4));
    let doubled = defect(&|m| m.faces.push(m.faces[middle].clone()));
    assert!(matches!(doubled, Defect::BranchingEdge { .. }), "{doubled:?}");
}
