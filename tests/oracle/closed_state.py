"""Closes an open cut sheet on paper and measures whether its pieces find room.

    closed_state.py cut.dxf hinges.json design.json --kerf MM [--tolerance MM2] [--curved]

What the cuts leave is severed at the ligaments by discs about the hinge points; every part is then carried by the
rigid motion of its piece from the open into the closed state, which must lie in a plane. Required: one part per
piece, and no two of them overlap when closed. With --curved the closed state lies on a surface: of every two
neighbouring pieces one is then seen straight from above the other. Prints one line of JSON; exit status 1 where something fails.
"""

import argparse
import json
import sys

import numpy as np
import shapely

from cut_file import flatten, read_dxf

CHORD_ERROR = 2e-5
QUAD_SEGS = 32
# Smaller specks are rounding of the overlay, mm2.
SPECK = 1e-6


def burned_body(paths, kerf):
    lines = [shapely.LineString(flatten(path, CHORD_ERROR)) for path in paths]
    body = shapely.Polygon(lines[-1].coords)
    grooves = shapely.union_all(shapely.buffer(np.array(lines), kerf / 2.0, quad_segs=QUAD_SEGS))
    for path, line in zip(paths, lines):
        if path.layer == "WINDOW":
            body = shapely.difference(body, shapely.Polygon(line.coords))
    return shapely.difference(body, grooves)


def plane_motion(start, end):
    """Rotation and shift of the plane that take the points `start` to `end`, and the largest miss."""
    a, b = start.mean(axis=0), end.mean(axis=0)
    (x, y), (u, v) = (start - a).T, (end - b).T
    angle = np.arctan2((x * v - y * u).sum(), (x * u + y * v).sum())
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    miss = np.linalg.norm((start - a) @ turn.T + b - end, axis=1).max()
    return turn, b - turn @ a, miss


def space_motion(start, end):
    """Rotation and shift of space that take the points `start` to `end` (Kabsch), and the largest miss."""
    a, b = start.mean(axis=0), end.mean(axis=0)
    u, _, vt = np.linalg.svd((start - a).T @ (end - b))
    turn = (u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt).T
    return turn, b - turn @ a, np.linalg.norm((start - a) @ turn.T + b - end, axis=1).max()


def neighbours_from_above(parts, pieces):
    """Pairs of neighbouring parts, the second moved to where it is when closed as the first one sees it."""
    motions = [space_motion(np.array(piece["open"]), np.array(piece["closed"])) for piece in pieces]
    centres = np.array([np.mean(piece["closed"], axis=0) for piece in pieces])
    reach = max(np.linalg.norm(np.subtract(piece["closed"], c), axis=1).max() for piece, c in zip(pieces, centres))
    pairs = []
    for p, q in zip(*np.nonzero(np.linalg.norm(centres[:, None] - centres, axis=2) < 2.2 * reach)):
        if p != q:
            (turn_p, shift_p, _), (turn_q, shift_q, _) = motions[p], motions[q]
            turn, shift = turn_p.T @ turn_q, turn_p.T @ (shift_q - shift_p)
            pairs.append((parts[p], shapely.transform(parts[q], lambda xy: xy @ turn[:2, :2].T + shift[:2])))
    return pairs, [miss for _, _, miss in motions]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dxf")
    parser.add_argument("hinges")
    parser.add_argument("design")
    parser.add_argument("--kerf", type=float, required=True)
    parser.add_argument("--tolerance", type=float, default=1e-4, help="mm2 of overlap")
    parser.add_argument("--curved", action="store_true", help="the closed state is not flat")
    args = parser.parse_args()
    with open(args.hinges, encoding="utf-8") as file:
        hinges = json.load(file)["hinges"]
    with open(args.design, encoding="utf-8") as file:
        pieces = json.load(file)["pieces"]
    _, _, paths, _ = read_dxf(args.dxf)
    body = burned_body(paths, args.kerf)
    # Wide enough to sever the ligament, however short it is.
    discs = [shapely.Point(h["point"][:2]).buffer(max(0.5 * h["length_mm"], 0.75 * h["width_mm"])) for h in hinges]
    parts = shapely.get_parts(shapely.difference(body, shapely.union_all(discs)))
    parts = parts[shapely.area(parts) > SPECK]
    closed, mine_of, misses, missing = [], [], [0.0], 0
    for piece in pieces:
        start, end = (np.array(piece[state])[:, :2] for state in ("open", "closed"))
        centre = shapely.Polygon(start).centroid
        mine = [part for part in parts if part.contains(centre)]
        if len(mine) != 1:
            missing += 1
            continue
        mine_of.append(mine[0])
        turn, shift, miss = plane_motion(start, end)
        misses.append(miss)
        closed.append(shapely.transform(mine[0], lambda xy, turn=turn, shift=shift: xy @ turn.T + shift))
    if args.curved:
        pairs, misses = neighbours_from_above(mine_of, pieces) if missing == 0 else ([], [np.inf])
    else:
        closed = np.array(closed)
        near = shapely.STRtree(closed).query(closed, predicate="dwithin", distance=1.0)
        pairs = [(closed[p], closed[q]) for p, q in zip(*near) if p < q]
    overlaps = [shapely.area(shapely.intersection(p, q)) for p, q in pairs]
    gaps = [shapely.distance(p, q) for p, q in pairs]
    worst = max(overlaps, default=0.0)
    ok = bool(missing == 0 and len(parts) == len(pieces) and worst <= args.tolerance)
    figures = {
        "parts": len(parts),
        "pieces": len(pieces),
        "missing": missing,
        "worst_overlap_mm2": round(float(worst), 6),
        "least_gap_mm": round(float(min(gaps, default=0.0)), 6),
        "worst_motion_miss_mm": round(float(max(misses)), 9),
    }
    print(json.dumps({"ok": ok, **figures}))
    sys.exit(0 if ok else 1)


if __name__ == "__main__":
    main()
