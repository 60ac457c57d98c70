"""Burns a cut file on paper and measures what is left.

    burn.py cut.dxf hinges.json design.json [--kerf MM] [--tolerance MM] [--sheet W H]

Every cut is widened to the kerf and taken from the area inside the border. Required: a clean file in
millimetres; no zero-length, duplicate or overlapping cut; the border closed and last; one connected body; every
ligament of its design width with its middle on the hinge point; every piece's centroid in the body.
Prints one line of JSON; exit status 1 with the reasons where something fails.
"""

import argparse
import json
import math
import sys
from collections import Counter

import numpy as np
import shapely

from cut_file import VERSIONS, flatten, read_dxf, segment_length

# Chords stay this close to arcs, mm: a thousandth of the usual tolerance.
CHORD_ERROR = 2e-5
# Segments per quarter circle at the ends of a burned groove: off by 3e-4 of half the kerf.
QUAD_SEGS = 32
# Shorter segments and overlaps do not count as such, mm.
ZERO_LENGTH = 1e-6
# Two cuts that run within SHADOW mm of each other for longer than SHADOW_LENGTH mm burn the same groove twice.
# Cuts that meet at an angle a do so for SHADOW / sin a: 0.05 mm means 1.1 degrees.
SHADOW, SHADOW_LENGTH = 1e-3, 0.05
# Smaller specks are rounding of the overlay, mm2.
SPECK = 1e-6
# Half angle of the cones in which a ligament's two sides are looked for.
CONE = math.radians(70.0)
# A ligament may be this much narrower than designed away from its middle, where the passing slit bends.
NECK_LOSS = 0.1
# No more than this many reasons of one sort are printed.
SHOWN = 5


class Report:
    """Reasons for refusal and figures."""

    def __init__(self):
        self.reasons, self.figures, self.counts = [], {}, Counter()

    def fail(self, sort, text):
        self.counts[sort] += 1
        if self.counts[sort] <= SHOWN:
            self.reasons.append(f"{sort}: {text}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dxf")
    parser.add_argument("hinges")
    parser.add_argument("design")
    parser.add_argument("--kerf", type=float, help="mm; default: the profile inside hinges.json")
    parser.add_argument("--tolerance", type=float, default=0.02, help="mm, of ligament width and centre")
    parser.add_argument("--sheet", type=float, nargs=2, help="mm; the burned cuts must lie inside")
    return parser.parse_args()


def kerf_in(hinges):
    """The first kerf_mm in a hinge report or in the profile inside it."""
    for holder in (hinges, hinges.get("profile")):
        if isinstance(holder, dict):
            for table in (holder, holder.get("laser")):
                if isinstance(table, dict) and "kerf_mm" in table:
                    return float(table["kerf_mm"])
    raise SystemExit("hinges.json names no kerf_mm: give --kerf")


def check_segments(paths, report):
    """Finite, long enough, no duplicate, no collinear overlap."""
    segments = [(i, s) for i, path in enumerate(paths) for s in path.segments()]
    seen = {}
    for index, (start, end, bulge) in segments:
        if not all(map(math.isfinite, (*start, *end, bulge))):
            report.fail("not finite", f"cut {index} {start} {end} {bulge}")
            return
        if segment_length(start, end, bulge) <= ZERO_LENGTH:
            report.fail("zero length", f"cut {index} at ({start[0]:.3f}, {start[1]:.3f})")
        ends = [tuple(round(c / ZERO_LENGTH) for c in p) for p in (start, end)]
        turned = ends[0] > ends[1]
        key = (*sorted(ends), round((-bulge if turned else bulge) / ZERO_LENGTH))
        if key in seen:
            report.fail("duplicate", f"cuts {seen[key]} and {index} at ({start[0]:.3f}, {start[1]:.3f})")
        seen.setdefault(key, index)
    check_collinear([(i, s) for i, s in segments if s[2] == 0.0], report)


def check_collinear(lines, report):
    if not lines:
        return
    a = np.array([s[0] for _, s in lines])
    b = np.array([s[1] for _, s in lines])
    tree = shapely.STRtree(shapely.linestrings(np.stack([a, b], axis=1)))
    i, j = tree.query(tree.geometries, predicate="dwithin", distance=ZERO_LENGTH)
    length = np.hypot(*(b - a).T)
    # Each pair once, measured along the longer one.
    once = (length[i] > length[j]) | ((length[i] == length[j]) & (i < j))
    i, j = i[once], j[once]
    along = (b[i] - a[i]) / length[i][:, None].clip(ZERO_LENGTH)

    def coordinates(point):
        d = point - a[i]
        return (d * along).sum(axis=1), along[:, 0] * d[:, 1] - along[:, 1] * d[:, 0]

    (s0, t0), (s1, t1) = coordinates(a[j]), coordinates(b[j])
    overlap = np.minimum(np.maximum(s0, s1), length[i]) - np.maximum(np.minimum(s0, s1), 0.0)
    bad = (np.abs(t0) <= ZERO_LENGTH) & (np.abs(t1) <= ZERO_LENGTH) & (overlap > ZERO_LENGTH)
    for p, q, common in zip(i[bad], j[bad], overlap[bad]):
        x, y = a[q]
        report.fail("overlap", f"cuts {lines[p][0]} and {lines[q][0]}, {common:.6f} mm at ({x:.3f}, {y:.3f})")


def check_shadows(lines, report):
    """No two paths run along each other."""
    tree = shapely.STRtree(lines)
    i, j = tree.query(lines, predicate="dwithin", distance=SHADOW)
    i, j = i[i < j], j[i < j]
    common = shapely.length(shapely.intersection(lines[i], shapely.buffer(lines[j], SHADOW)))
    for p, q, length in zip(i, j, common):
        if length > SHADOW_LENGTH:
            x, y = shapely.get_coordinates(lines[q])[0]
            report.fail("overlap", f"cuts {p} and {q} run together for {length:.3f} mm, from ({x:.3f}, {y:.3f})")


def check_border(paths, report):
    """The border's polygon: closed, and the last cut."""
    borders = [i for i, path in enumerate(paths) if path.layer == "BORDER"]
    if len(borders) != 1:
        report.fail("border", f"{len(borders)} border cuts, not 1")
        return None
    if borders[0] != len(paths) - 1:
        report.fail("border", f"is cut {borders[0]} of {len(paths)}, not the last")
    border = paths[borders[0]]
    if not border.closed:
        report.fail("border", "is open")
        return None
    polygon = shapely.Polygon(flatten(border, CHORD_ERROR))
    if not polygon.is_valid:
        report.fail("border", f"crosses itself: {shapely.is_valid_reason(polygon)}")
        return None
    return polygon


def burn(paths, grooves, border, report):
    """What is left inside the border: the largest body."""
    material = shapely.difference(border, shapely.union_all(grooves))
    for path in paths:
        if path.layer == "WINDOW":
            if not path.closed:
                report.fail("window", "is open")
            else:
                material = shapely.difference(material, shapely.Polygon(flatten(path, CHORD_ERROR)))
    parts = shapely.get_parts(material)
    parts = parts[shapely.area(parts) > SPECK]
    report.figures["bodies"] = len(parts)
    if len(parts) == 0:
        report.fail("bodies", "nothing is left inside the border")
        return None
    order = np.argsort(-shapely.area(parts))
    for part in parts[order[1:]]:
        centre = part.representative_point()
        report.fail("bodies", f"{part.area:.4f} mm2 falls out at ({centre.x:.3f}, {centre.y:.3f})")
    body = parts[order[0]]
    report.figures["body_area_mm2"] = round(body.area, 6)
    return body


def cone(point, direction, radius):
    """The part of a disc about `point` within CONE of a direction."""
    angle = math.atan2(direction[1], direction[0])
    angles = np.linspace(angle - CONE, angle + CONE, 33)
    arc = point + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return shapely.Polygon(np.vstack([point, arc]))


def measure_ligament(point, grooves, reach, half_length):
    """(width through the hinge point, offset of its middle, least width along the ligament), or a reason.

    The nearest burned edge gives one side; the other is sought in a cone the opposite way.
    """
    disc = shapely.Point(point).buffer(reach, quad_segs=16)
    burned = shapely.union_all(shapely.intersection(grooves, disc))
    here = shapely.Point(point)
    near = here.distance(burned) if not burned.is_empty else math.inf
    if near == 0.0:
        return "the hinge point itself is burned"
    if math.isinf(near):
        return f"no cut within {reach:.3f} mm"
    foot = shapely.get_coordinates(shapely.shortest_line(here, burned))[1]
    side = (foot - point) / near
    far = here.distance(shapely.intersection(burned, cone(point, -side, reach)))
    if math.isnan(far) or math.isinf(far):
        return f"no cut on the far side within {reach:.3f} mm"
    # At least as far as the two edges measured above, however short the ligament.
    extent = max(half_length, 1.001 * far)
    walls = [shapely.intersection(burned, cone(point, way, extent)) for way in (side, -side)]
    return near + far, (far - near) / 2.0, walls[0].distance(walls[1])


def check_ligaments(hinges, grooves, tolerance, report):
    tree = shapely.STRtree(grooves)
    worst = {"worst_width_error_mm": 0.0, "worst_centre_offset_mm": 0.0, "worst_neck_loss_mm": 0.0}
    for number, hinge in enumerate(hinges):
        point = np.array(hinge["point"][:2], dtype=float)
        width, half_length = float(hinge["width_mm"]), float(hinge.get("length_mm", 0.0)) / 2.0
        reach = max(4.0 * width, half_length + width)
        near = np.sort(tree.query(shapely.Point(point), predicate="dwithin", distance=reach))
        measured = measure_ligament(point, grooves[near], reach, half_length)
        name = f"hinge {hinge.get('id', number)} at ({point[0]:.3f}, {point[1]:.3f})"
        if isinstance(measured, str):
            report.fail("ligament", f"{name}: {measured}")
            continue
        found, offset, neck = measured
        # The report may own up to an offset that the pattern forces.
        excess = abs(offset) - abs(float(hinge.get("centre_offset_mm", 0.0)))
        for key, value in zip(worst, (abs(found - width), abs(offset), width - neck)):
            worst[key] = max(worst[key], value)
        if abs(found - width) > tolerance:
            report.fail("ligament width", f"{name}: {found:.4f} mm, design {width:.4f} mm")
        if excess > tolerance:
            report.fail("ligament centre", f"{name}: {offset:.4f} mm off the hinge point")
        if width - neck > max(tolerance, NECK_LOSS * width):
            report.fail("ligament neck", f"{name}: {neck:.4f} mm at its narrowest, design {width:.4f} mm")
    report.figures["hinges"] = len(hinges)
    report.figures.update({key: round(value, 6) for key, value in worst.items()})


def inner_point(polygon, clear):
    """The centroid; of a piece like a hook, which does not have it well inside, another point that is."""
    inside = polygon.buffer(-clear)
    if inside.is_empty or inside.contains(polygon.centroid):
        return polygon.centroid
    return inside.representative_point()


def check_pieces(design, hinges, body, clear, report):
    state = design.get("sheet_state") or "closed"
    pieces = design["pieces"]
    centres = [inner_point(shapely.Polygon([v[:2] for v in piece[state]]), clear) for piece in pieces]
    shapely.prepare(body)
    for index in np.flatnonzero(~shapely.contains(body, np.array(centres))):
        report.fail("piece", f"{index}: middle ({centres[index].x:.3f}, {centres[index].y:.3f}) is not in the body")
    report.figures["pieces"] = len(pieces)
    if "hinges" in design:
        points = [np.array(h["point"]) for h in design["hinges"]], [np.array(h["point"]) for h in hinges]
        if len(points[0]) != len(points[1]):
            report.fail("hinges", f"{len(points[0])} in the design, {len(points[1])} in the report")
        elif max((np.abs(p - q).max() for p, q in zip(*points)), default=0.0) > ZERO_LENGTH:
            report.fail("hinges", "the design and the report place them differently")


def run(args, report):
    with open(args.hinges, encoding="utf-8") as file:
        hinge_report = json.load(file)
    with open(args.design, encoding="utf-8") as file:
        design = json.load(file)
    kerf = args.kerf if args.kerf is not None else kerf_in(hinge_report)
    document, _, paths, reasons = read_dxf(args.dxf)
    for reason in reasons:
        report.fail("file", reason)
    lengths = Counter()
    for path in paths:
        lengths[path.layer] += path.length()
    report.figures.update(
        version=VERSIONS.get(document.dxfversion, document.dxfversion),
        kerf_mm=kerf,
        cuts=dict(sorted(Counter(path.layer for path in paths).items())),
        length_mm={layer: round(value, 6) for layer, value in sorted(lengths.items())},
    )
    check_segments(paths, report)
    if "not finite" in report.counts or not paths:
        return report.fail("file", "no cuts that can be burned")
    lines = np.array([shapely.LineString(flatten(path, CHORD_ERROR)) for path in paths])
    check_shadows(lines, report)
    grooves = shapely.buffer(lines, kerf / 2.0, quad_segs=QUAD_SEGS)
    if args.sheet and not shapely.box(0.0, 0.0, *args.sheet).covers(shapely.box(*shapely.total_bounds(grooves))):
        report.fail("sheet", f"cuts leave the sheet of {args.sheet[0]} x {args.sheet[1]} mm")
    border = check_border(paths, report)
    body = burn(paths, grooves, border, report) if border is not None else None
    check_ligaments(hinge_report["hinges"], grooves, args.tolerance, report)
    if body is not None:
        check_pieces(design, hinge_report["hinges"], body, kerf, report)
    return None


def main():
    report = Report()
    run(arguments(), report)
    counts = dict(sorted(report.counts.items()))
    print(json.dumps({"ok": not counts, **report.figures, "failures": counts, "reasons": report.reasons}))
    sys.exit(1 if counts else 0)


if __name__ == "__main__":
    main()
