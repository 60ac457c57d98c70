"""Checks a folder of results as a whole: made_folder.py FOLDER target.obj --scale MM_PER_UNIT | --size MM

Prints one line of JSON with what was found:
  files            the names in the folder, sorted
  xml              root elements of the SVG files
  csv_rows         rows of hinges.csv below its header
  hinges           rows of hinges.json
  verdicts         how often each verdict stands in hinges.json
  distance_mm      largest distance of a vertex of an open piece from the target, by brute force over all triangles
  boundary_mm      largest distance between the target's boundary and the open pattern's, either way
  diagonal_mm      of the target's bounding box
  normal           mean of the open pieces' unit normals along the target's normal at the nearest triangle
"""

import argparse
import csv
import json
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

import numpy as np

# Rows of points per block of the brute force: 256 points against a few thousand triangles are some 100 MB.
BLOCK = 256


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("target", type=Path)
    scale = parser.add_mutually_exclusive_group(required=True)
    scale.add_argument("--scale", type=float, help="millimetres per unit of the target")
    scale.add_argument("--size", type=float, help="millimetres of the target's largest extent")
    return parser.parse_args()


def read_obj(file):
    """Vertices and faces of an OBJ file; faces as lists of indices from 0."""
    vertices, faces = [], []
    for line in file.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            indices = [int(word.split("/")[0]) for word in words[1:]]
            faces.append([i - 1 if i > 0 else len(vertices) + i for i in indices])
    return np.array(vertices), faces


def triangles_of(vertices, faces):
    """Triangles; quads from their centre, which prefers neither diagonal of a warped one."""
    corners = []
    for face in faces:
        points = vertices[np.array(face)]
        if len(face) == 3:
            corners.append(points)
        else:
            centre = points.mean(axis=0)
            corners += [(p, q, centre) for p, q in zip(points, np.roll(points, -1, axis=0))]
    return np.array(corners)


def segment_distances(points, start, end):
    """#points x #segments distances."""
    along = end - start
    t = np.einsum("psk,sk->ps", points[:, None] - start, along) / np.einsum("sk,sk->s", along, along)
    foot = start + np.clip(t, 0.0, 1.0)[..., None] * along
    return np.linalg.norm(points[:, None] - foot, axis=2)


def triangle_distances(points, triangles):
    """#points x #triangles distances: to the plane where the foot lies inside, else to the nearest edge."""
    a, b, c = triangles.transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    height = np.einsum("ptk,tk->pt", points[:, None] - a, normals)
    inside = np.ones(height.shape, dtype=bool)
    edges = np.full(height.shape, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        inward = np.cross(normals, end - start)
        inside &= np.einsum("ptk,tk->pt", points[:, None] - start, inward) >= 0.0
        edges = np.minimum(edges, segment_distances(points, start, end))
    return np.where(inside, np.abs(height), edges)


def nearest(points, triangles):
    """Distance to and index of the nearest triangle of each point."""
    blocks = [triangle_distances(points[i : i + BLOCK], triangles) for i in range(0, len(points), BLOCK)]
    return np.concatenate([b.min(axis=1) for b in blocks]), np.concatenate([b.argmin(axis=1) for b in blocks])


def boundary_edges(faces):
    """Directed edges that no other face runs through the other way."""
    directed = {(face[i - 1], face[i]) for face in faces for i in range(len(face))}
    return np.array(sorted((a, b) for a, b in directed if (b, a) not in directed))


def pattern_boundary(design):
    """The open pattern's outer edges: sides of pieces between corners that only one piece has."""
    sides = Counter()
    for piece in design["pieces"]:
        corners = piece["corners"]
        sides.update(frozenset((corners[i - 1], corners[i])) for i in range(len(corners)))
    edges = []
    for piece in design["pieces"]:
        corners, opened = piece["corners"], piece["open"]
        for i in range(len(corners)):
            if sides[frozenset((corners[i - 1], corners[i]))] == 1:
                edges.append((opened[i - 1], opened[i]))
    return np.array(edges)


def boundary_distance(design, vertices, faces):
    """Both ways: vertices of one boundary to the segments of the other.

    The pattern's outline also runs along holes that open at its border; those stand at most a side off, so they add
    nothing to the way from the target to the pattern, and the way back goes from the pieces' outer sides alone.
    """
    loop = boundary_edges(faces)
    start, end = vertices[loop[:, 0]], vertices[loop[:, 1]]
    outer = pattern_boundary(design)
    there = segment_distances(start, outer[:, 0], outer[:, 1]).min(axis=1).max()
    back = segment_distances(outer.reshape(-1, 3), start, end).min(axis=1).max()
    return float(max(there, back))


def mean_normal(pieces, triangles):
    """Mean cosine between the pieces' normals in the open state and the target's beside them."""
    centres = np.array([np.mean(piece["open"], axis=0) for piece in pieces])
    diagonals = np.array([[np.subtract(p[2], p[0]), np.subtract(p[3], p[1])] for p in (q["open"] for q in pieces)])
    normals = np.cross(diagonals[:, 0], diagonals[:, 1])
    _, at = nearest(centres, triangles)
    a, b, c = triangles[at].transpose(1, 0, 2)
    targets = np.cross(b - a, c - a)
    cosines = (normals * targets).sum(axis=1) / np.linalg.norm(normals, axis=1) / np.linalg.norm(targets, axis=1)
    return float(cosines.mean())


def main():
    args = arguments()
    folder = args.folder
    design, report = (json.loads((folder / name).read_text(encoding="utf-8")) for name in ("design.json", "hinges.json"))
    with open(folder / "hinges.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file, strict=True))
    vertices, faces = read_obj(args.target)
    used = vertices[sorted({i for face in faces for i in face})]
    extent = used.max(axis=0) - used.min(axis=0)
    scale = args.scale if args.scale is not None else args.size / extent.max()
    vertices = vertices * scale
    triangles = triangles_of(vertices, faces)
    points = np.unique(np.array([point for piece in design["pieces"] for point in piece["open"]]), axis=0)
    print(
        json.dumps(
            {
                "files": sorted(path.name for path in folder.iterdir()),
                "xml": [ElementTree.parse(path).getroot().tag for path in sorted(folder.glob("*.svg"))],
                "csv_rows": len(rows) - 1,
                "hinges": len(report["hinges"]),
                "verdicts": Counter(row["verdict"] for row in report["hinges"]),
                "distance_mm": float(nearest(points, triangles)[0].max()),
                "boundary_mm": boundary_distance(design, vertices, faces),
                "diagonal_mm": float(np.linalg.norm(extent) * scale),
                "normal": mean_normal(design["pieces"], triangles),
            }
        )
    )


if __name__ == "__main__":
    main()
