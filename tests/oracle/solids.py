"""Reads a sheet's solids with trimesh and compares the part with the burned cut file: solids.py FOLDER MOVED THICKNESS [KERF]

FOLDER holds part.stl, MOVED (open.stl or closed.stl), cut.dxf and design.json. Prints one line of JSON:
  part, moved       each: watertight, winding (both after trimesh merged equal vertices), volume, bodies, least triangle area
  burned_area       area inside the border, less windows and all cuts at the kerf's width, by shapely
  cut_length        length of all cuts
  sections          of the part at three heights: area, valid, bodies
  centre_offset     largest distance between a moved solid's centre and the middle of its piece's polygon in that state
  height            of the part: lowest and highest z
"""

import json
import sys
from pathlib import Path

import numpy as np
import shapely
import trimesh

from cut_file import flatten, read_dxf


def labels(mesh):
    """A number per vertex, the same for all vertices of one body."""
    found = np.arange(len(mesh.vertices))
    edges = mesh.edges_unique
    while True:
        least = np.minimum(found[edges[:, 0]], found[edges[:, 1]])
        before = found.copy()
        np.minimum.at(found, edges[:, 0], least)
        np.minimum.at(found, edges[:, 1], least)
        found = found[found]
        if (found == before).all():
            return found


def figures(mesh):
    return {
        "watertight": bool(mesh.is_watertight),
        "winding": bool(mesh.is_winding_consistent),
        "volume": float(mesh.volume),
        "bodies": len(np.unique(labels(mesh))),
        "least_area": float(mesh.area_faces.min()),
        "triangles": len(mesh.faces),
    }


def region(mesh, z):
    """The region that a plane cuts out of a mesh without vertices at its height."""
    corners = mesh.triangles
    sides = []
    for k in range(3):
        p, q = corners[:, k], corners[:, (k + 1) % 3]
        low = np.where((p[:, 2] < q[:, 2])[:, None], p, q)
        high = np.where((p[:, 2] < q[:, 2])[:, None], q, p)
        crosses = (low[:, 2] < z) & (high[:, 2] > z)
        part = np.where(crosses, (z - low[:, 2]) / np.where(crosses, high[:, 2] - low[:, 2], 1.0), 0.0)
        sides.append((crosses, low[:, :2] + part[:, None] * (high - low)[:, :2]))
    lines = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        both = sides[i][0] & sides[j][0]
        lines.append(np.stack([sides[i][1][both], sides[j][1][both]], axis=1))
    lines = np.round(np.concatenate(lines), 9)
    lines = lines[(lines[:, 0] != lines[:, 1]).any(axis=1)]
    return shapely.build_area(shapely.multilinestrings(shapely.linestrings(lines)))


def section(mesh, z):
    found = region(mesh, z)
    return {"area": found.area, "valid": bool(found.is_valid), "bodies": len(shapely.get_parts(found))}


def burned(name, kerf):
    _, _, paths, _ = read_dxf(name)
    lines = {kind: [] for kind in ("BORDER", "WINDOW", "")}
    for path in paths:
        points = flatten(path, 2e-5)
        lines[path.layer if path.layer in lines else ""].append(points)
    sheet = shapely.Polygon(lines["BORDER"][0], lines["WINDOW"])
    every = [shapely.LineString(points) for group in lines.values() for points in group]
    grooves = shapely.union_all(shapely.buffer(every, kerf / 2.0, quad_segs=32))
    return sheet.difference(grooves).area, sum(line.length for line in every)


def centre_offset(mesh, pieces):
    label = labels(mesh)
    # trimesh keeps the file's order of bodies in the least face of each.
    first = {}
    for face, body in enumerate(label[mesh.faces[:, 0]]):
        first.setdefault(body, face)
    worst = 0.0
    for body, piece in zip(first, pieces, strict=True):
        faces = mesh.triangles[label[mesh.faces[:, 0]] == body]
        areas = np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1)
        centre = np.average(faces.mean(axis=1), axis=0, weights=areas)
        worst = max(worst, float(np.linalg.norm(centre - np.mean(piece, axis=0))))
    return worst


def main():
    folder, name, thickness = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])
    kerf = float(sys.argv[4]) if len(sys.argv) > 4 else 0.05
    part, moved = trimesh.load(folder / "part.stl"), trimesh.load(folder / name)
    design = json.loads((folder / "design.json").read_text())
    area, length = burned(folder / "cut.dxf", kerf)
    state = name.removesuffix(".stl")
    print(
        json.dumps(
            {
                "part": figures(part),
                "moved": figures(moved),
                "burned_area": area,
                "cut_length": length,
                "sections": [section(part, z * thickness) for z in (-0.49, 0.003, 0.37)],
                "centre_offset": centre_offset(moved, [piece[state] for piece in design["pieces"]]),
                "height": part.bounds[:, 2].tolist(),
            }
        )
    )


if __name__ == "__main__":
    main()
