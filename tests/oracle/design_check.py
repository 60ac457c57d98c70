"""Recomputes from the coordinates of a design.json what the file says about itself: design_check.py design.json

Prints one line of JSON: the figures found here, and how far the file's own are from them:
  e_isom_difference       difference of the square roots, which is at most the norm of the residuals' rounding
  length_difference       of max_length_error
  planarity_difference    of planarity
  apart_mm                largest distance between the two vertices of a hinge, in both states
  point_mm                largest distance of a hinge's point from its vertex in the sheet state
  rotation_difference     largest entry of R(axis, angle) - A_j^T A_k, with A the best rotation of a piece (Kabsch)
  motion_mm               largest distance between piece k moved by the hinge's turn and piece j's view of the open piece k
"""

import json
import sys

import numpy as np


def kabsch(start, end):
    """Rotation and translation that take `start` to `end`, rows of points; never a mirror."""
    from_centre, to_centre = start.mean(axis=0), end.mean(axis=0)
    u, _, vt = np.linalg.svd((start - from_centre).T @ (end - to_centre))
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = (u @ flip @ vt).T
    return rotation, to_centre - rotation @ from_centre


def rodrigues(axis, angle):
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def pair_lengths(points):
    rows, columns = np.triu_indices(len(points), 1)
    return np.linalg.norm(points[rows] - points[columns], axis=1)


def off_plane(points):
    """Largest distance from the plane through the centre along the two larger principal directions."""
    centred = points - points.mean(axis=0)
    _, _, vt = np.linalg.svd(centred)
    return np.abs(centred @ vt[2]).max()


def mean_edge(design):
    corners = np.array(design["corners"])
    lengths = [
        np.linalg.norm(corners[piece["corners"]] - np.roll(corners[piece["corners"]], 1, axis=0), axis=1)
        for piece in design["pieces"]
    ]
    return float(np.concatenate(lengths).mean())


def hinge_figures(design, pieces):
    sheet, other = ("open", "closed") if design["sheet_state"] == "open" else ("closed", "open")
    motions = [kabsch(piece[sheet], piece[other]) for piece in pieces]
    apart = point = rotation = motion = 0.0
    for hinge in design["hinges"]:
        (j, k), (v, w) = hinge["pieces"], hinge["vertices"]
        for state in (sheet, other):
            apart = max(apart, np.linalg.norm(pieces[j][state][v] - pieces[k][state][w]))
        at = np.array(hinge["point"])
        point = max(point, np.linalg.norm(pieces[j][sheet][v] - at))
        turn = rodrigues(hinge["axis"], np.radians(hinge["angle_deg"]))
        (a_j, t_j), (a_k, _) = motions[j], motions[k]
        rotation = max(rotation, np.abs(turn - a_j.T @ a_k).max())
        seen = (pieces[k][other] - t_j) @ a_j
        motion = max(motion, np.abs(at + (pieces[k][sheet] - at) @ turn.T - seen).max())
    return {"apart_mm": apart, "point_mm": point, "rotation_difference": rotation, "motion_mm": motion}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        design = json.load(file)
    report = design["report"]
    pieces = [{state: np.array(piece[state]) for state in ("closed", "open")} for piece in design["pieces"]]
    edge = mean_edge(design)
    closed, opened = (np.concatenate([pair_lengths(piece[state]) for piece in pieces]) for state in ("closed", "open"))
    e_isom = float((((closed**2 - opened**2) / edge**2) ** 2).sum())
    length_error = float(np.abs((closed - opened) / closed).max())
    planarity = max(off_plane(piece[state]) for piece in pieces for state in piece) / edge
    angles = [hinge["angle_deg"] for hinge in design["hinges"]]
    figures = {
        "pieces": len(pieces),
        "hinges": len(design["hinges"]),
        "e_isom": e_isom,
        "max_length_error": length_error,
        "planarity": planarity,
        "mean_edge_mm": edge,
        "least_angle_deg": min(angles),
        "largest_angle_deg": max(angles),
        "e_isom_difference": abs(np.sqrt(e_isom) - np.sqrt(report["e_isom"])),
        "length_difference": abs(length_error - report["max_length_error"]),
        "planarity_difference": abs(planarity - report["planarity"]),
        "mean_edge_difference": abs(edge - report["mean_edge_mm"]),
        **hinge_figures(design, pieces),
    }
    print(json.dumps({key: float(value) for key, value in figures.items()}))


if __name__ == "__main__":
    main()
