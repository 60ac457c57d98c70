"""Mills a part on paper from poses of the tool and compares it with its solid: milled.py POSES FOLDER RADIUS THICKNESS WEDGE

POSES: lines "x y z i j k r|f speed" on the table, as rs274_poses.py prints them. FOLDER: part.stl with mid-plane z = 0, and hinges.json with the
tabs. WEDGE:
degrees by which the stock is turned about the table's y through the program's zero, which is on top of it. Nothing here comes from
the program under test: sections of the tool are strips of shapely about the line of its axis. Prints one line of JSON: per height
the widest strip of the part that the tool takes, the largest distance of the part's boundary from what it takes (outside of
tabs), and the number of bodies of the part's section.
"""

import json
import math
import sys
from pathlib import Path

import numpy as np
import shapely
import trimesh

from solids import region

poses_file, folder = sys.argv[1], Path(sys.argv[2])
radius, thickness, wedge = map(float, sys.argv[3:6])

rows = [line.split() for line in open(poses_file) if line.strip()]
poses = np.array([[float(v) for v in row[:6]] for row in rows])
feeds = np.array([row[6] == "f" for row in rows])
c, s = math.cos(math.radians(-wedge)), math.sin(math.radians(-wedge))
turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
tips, axes = poses[:, :3] @ turn.T, poses[:, 3:] @ turn.T

part = trimesh.load(folder / "part.stl", process=False)
tabs = json.loads((folder / "hinges.json").read_text())["mill"]["tabs"]
bridges = shapely.union_all([shapely.Point(tab["at_mm"]).buffer(tab["reach_mm"]) for tab in tabs])


def swept(z):
    """What the tool takes at a height above the top of the stock: moves whose flat end is all below."""
    rim = radius * np.hypot(axes[:, 0], axes[:, 1])
    through = tips[:, 2] + rim <= z
    at = tips[:, :2] + (z - tips[:, 2])[:, None] * axes[:, :2] / axes[:, 2:]
    both = feeds[1:] & through[1:] & through[:-1]
    lines = np.round(np.stack([at[:-1][both], at[1:][both]], axis=1), 4)
    lines = np.unique(lines.reshape(len(lines), 4), axis=0).reshape(-1, 2, 2)
    lengths = np.hypot(*(lines[:, 1] - lines[:, 0]).T)
    strips = shapely.linestrings(lines[lengths > 0])
    return shapely.union_all(shapely.buffer(strips, radius, quad_segs=48))


found = []
for part_of in (0.02, 0.5, 0.98):
    z = (part_of - 1.0) * thickness
    taken = swept(z)
    solid = region(part, z + 0.5 * thickness)
    lost = solid.intersection(taken)
    depth = 0.0
    while depth < 0.2 and not lost.buffer(-0.5 * (depth + 0.001)).is_empty:
        depth += 0.001
    shapely.prepare(taken)
    rim = shapely.difference(solid.boundary, bridges)
    points = shapely.get_coordinates(shapely.segmentize(rim, 0.5))
    left = float(shapely.distance(shapely.points(points), taken).max())
    found.append({"z": z, "lost_mm": depth, "left_mm": left, "bodies": len(getattr(solid, "geoms", [solid]))})
print(json.dumps({"heights": found}))
