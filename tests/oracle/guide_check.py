"""How near the open state of a design comes to a curve: guide_check.py design.json line.obj arch.obj

The points of the line are moved with the closed piece whose centre is nearest; the distance is that to the arch, which
goes on straight beyond its ends. Prints one line of JSON:
  mean_distance_mm, max_distance_mm   of the line's points from the arch
  box_difference_mm                   of the reported bounding box of the open state
  area_mm2                            of the closed cells, times the reported area_expansion
  least_fold_cosine                   between the normals of open pieces that share a hinge
"""

import json
import sys

import numpy as np
from design_check import kabsch


def points(path):
    return np.array([line.split()[1:4] for line in open(path) if line.startswith("v ")], float)


def distance(p, curve):
    best = np.inf
    for i, (a, b) in enumerate(zip(curve, curve[1:])):
        t = (p - a) @ (b - a) / ((b - a) @ (b - a))
        low, high = (-np.inf if i == 0 else 0.0), (np.inf if i == len(curve) - 2 else 1.0)
        best = min(best, np.linalg.norm(a + np.clip(t, low, high) * (b - a) - p))
    return best


def normal(piece):
    n = np.cross(piece[2] - piece[0], piece[3] - piece[1])
    return n / np.linalg.norm(n)


design = json.load(open(sys.argv[1]))
line, arch = points(sys.argv[2]), points(sys.argv[3])
closed = [np.array(piece["closed"]) for piece in design["pieces"]]
opened = [np.array(piece["open"]) for piece in design["pieces"]]
centres = np.array([piece.mean(axis=0) for piece in closed])
found = []
for p in line:
    k = np.linalg.norm(centres - p, axis=1).argmin()
    rotation, translation = kabsch(closed[k], opened[k])
    found.append(distance(rotation @ p + translation, arch))
everything = np.concatenate(opened)
report = design["report"]["open_state"]
box = np.array([everything.min(axis=0) - report["low_mm"], everything.max(axis=0) - report["high_mm"]])
corners = np.array(design["corners"])
cells = [corners[piece["corners"]] for piece in design["pieces"]]
area = sum(np.linalg.norm(np.cross(cell[2] - cell[0], cell[3] - cell[1])) / 2.0 for cell in cells)
cosines = [normal(opened[j]) @ normal(opened[k]) for j, k in (hinge["pieces"] for hinge in design["hinges"])]
print(
    json.dumps(
        {
            "mean_distance_mm": float(np.mean(found)),
            "max_distance_mm": float(np.max(found)),
            "box_difference_mm": float(np.abs(box).max()),
            "area_mm2": float(area * design["report"]["area_expansion"]),
            "least_fold_cosine": float(min(cosines)),
        }
    )
)
