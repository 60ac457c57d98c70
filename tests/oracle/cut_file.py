"""Independent readers of our cut files: DXF through ezdxf, SVG through the standard library.

A path is (layer, vertices, closed); a vertex is (x, y, bulge) in millimetres, y up, with the bulge
tan(sweep/4) of the segment that leaves it, positive counter-clockwise.
"""

import math
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import ezdxf

CUT_LAYERS = ("SLIT", "RELIEF", "WINDOW", "BORDER", "LEAD")
NOTE_LAYER = "NOTE"
ENGRAVE_LAYER = "ENGRAVE"
VERSIONS = {"AC1015": "R2000", "AC1009": "R12"}
# Ends closer than this are one point, mm: far below a kerf, far above twelve printed decimals.
SAME_POINT = 1e-7


@dataclass
class Path:
    layer: str
    vertices: list
    closed: bool

    def segments(self):
        """(start, end, bulge) of every segment."""
        ends = self.vertices[1:] + (self.vertices[:1] if self.closed else [])
        return [(a[:2], b[:2], a[2]) for a, b in zip(self.vertices, ends)]

    def length(self):
        return sum(segment_length(*segment) for segment in self.segments())


def segment_length(start, end, bulge):
    chord = math.dist(start, end)
    if bulge == 0.0:
        return chord
    radius = chord * (1.0 + bulge * bulge) / (4.0 * abs(bulge))
    return radius * 4.0 * math.atan(abs(bulge))


def flatten(path, chord_error):
    """Points along a path, arcs replaced by chords that stay within `chord_error` mm of them."""
    points = [path.vertices[0][:2]]
    for start, end, bulge in path.segments():
        points.extend(arc_points(start, end, bulge, chord_error))
        points.append(end)
    return points


def arc_points(start, end, bulge, chord_error):
    """Points strictly between the ends of an arc; none on a straight line."""
    if bulge == 0.0:
        return []
    sweep = 4.0 * math.atan(bulge)
    (x0, y0), (x1, y1) = start, end
    # Rotate about the centre, which lies on the chord's bisector at cot(sweep/2) half chords to the left.
    cot = 1.0 / math.tan(sweep / 2.0) if abs(abs(sweep) - math.pi) > 1e-12 else 0.0
    cx = (x0 + x1) / 2.0 - (y1 - y0) / 2.0 * cot
    cy = (y0 + y1) / 2.0 + (x1 - x0) / 2.0 * cot
    radius = math.hypot(x0 - cx, y0 - cy)
    step = 2.0 * math.acos(max(-1.0, 1.0 - chord_error / radius)) if chord_error < radius else math.pi / 8
    count = max(2, math.ceil(abs(sweep) / step))
    first = math.atan2(y0 - cy, x0 - cx)
    angles = [first + sweep * i / count for i in range(1, count)]
    return [(cx + radius * math.cos(a), cy + radius * math.sin(a)) for a in angles]


def read_dxf(name):
    """Strict reading. Returns (document, auditor, paths in file order, reasons why it is no cut file)."""
    document = ezdxf.readfile(name)
    auditor = document.audit()
    reasons = header_reasons(document, auditor)
    paths, chain = [], None
    for entity in document.modelspace():
        kind, layer = entity.dxftype(), entity.dxf.layer
        if (kind == "TEXT" and layer == NOTE_LAYER) or (kind in ("LWPOLYLINE", "LINE") and layer == ENGRAVE_LAYER):
            continue
        if layer not in CUT_LAYERS or kind not in ("LWPOLYLINE", "LINE", "ARC"):
            reasons.append(f"{kind} on layer {layer}: neither a cut nor a note")
        elif kind == "LWPOLYLINE":
            vertices = [tuple(map(float, v)) for v in entity.get_points("xyb")]
            paths.append(Path(layer, vertices, bool(entity.closed)))
            chain = None
        else:
            chain = extend(paths, chain, layer, line_or_arc(entity))
    return document, auditor, paths, reasons


def header_reasons(document, auditor):
    reasons = [f"audit error: {e.message}" for e in auditor.errors]
    reasons += [f"audit fix: {e.message}" for e in auditor.fixes]
    if document.dxfversion not in VERSIONS:
        return reasons + [f"version {document.dxfversion}, not one of {sorted(VERSIONS)}"]
    if VERSIONS[document.dxfversion] == "R2000":
        for variable, value in (("$INSUNITS", 4), ("$MEASUREMENT", 1)):
            found = document.header.get(variable)
            if found != value:
                reasons.append(f"{variable} is {found}, not {value} (millimetres)")
        if document.layers.has_entry(NOTE_LAYER) and document.layers.get(NOTE_LAYER).dxf.plot != 0:
            reasons.append(f"layer {NOTE_LAYER} is plotted")
    names = {layer.dxf.name for layer in document.layers}
    for layer in sorted({"SLIT", "RELIEF", "WINDOW", "BORDER", "NOTE"} - names):
        reasons.append(f"layer {layer} is missing")
    return reasons


def line_or_arc(entity):
    """(start, end, bulge) of a LINE or ARC."""
    if entity.dxftype() == "LINE":
        start, end = entity.dxf.start, entity.dxf.end
        return (start.x, start.y), (end.x, end.y), 0.0
    sweep = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
    start, end = entity.start_point, entity.end_point
    return (start.x, start.y), (end.x, end.y), math.tan(sweep / 4.0)


def extend(paths, chain, layer, segment):
    """Joins a LINE or ARC to the path before it where they share an end; returns the path to extend next."""
    start, end, bulge = segment
    if chain is not None and chain.layer == layer:
        tail = chain.vertices[-1][:2]
        if len(chain.vertices) == 2 and min(math.dist(tail, start), math.dist(tail, end)) > SAME_POINT:
            # The first segment may have been written backwards (an ARC is always counter-clockwise).
            (x0, y0, b0), (x1, y1, _) = chain.vertices
            if min(math.dist((x0, y0), start), math.dist((x0, y0), end)) <= SAME_POINT:
                chain.vertices = [(x1, y1, -b0), (x0, y0, 0.0)]
                tail = (x0, y0)
        if math.dist(tail, start) > SAME_POINT and math.dist(tail, end) <= SAME_POINT:
            start, end, bulge = end, start, -bulge
        if math.dist(tail, start) <= SAME_POINT:
            chain.vertices[-1] = (*chain.vertices[-1][:2], bulge)
            if math.dist(chain.vertices[0][:2], end) <= SAME_POINT:
                chain.closed = True
                return None
            chain.vertices.append((*end, 0.0))
            return chain
    paths.append(Path(layer, [(*start, bulge), (*end, 0.0)], False))
    return paths[-1]


def read_svg(name):
    """Paths of an SVG in millimetres, y turned up again. Returns (size in mm, paths, texts)."""
    root = ElementTree.parse(name).getroot()
    width, height = (float(root.get(key).removesuffix("mm")) for key in ("width", "height"))
    if [float(v) for v in root.get("viewBox").split()] != [0.0, 0.0, width, height]:
        raise ValueError(f"viewBox {root.get('viewBox')} is not the sheet in millimetres")
    paths, texts = [], []
    for element in root:
        tag = element.tag.removeprefix("{http://www.w3.org/2000/svg}")
        if tag == "path":
            paths.append(svg_path(element, height))
        elif tag == "text":
            texts.append(element.text.strip())
        else:
            raise ValueError(f"element {tag}: neither a cut nor a note")
    return (width, height), paths, texts


def svg_path(element, height):
    vertices, closed = [], False
    for command, numbers in re.findall(r"([A-Za-z])([^A-Za-z]*)", element.get("d")):
        values = [float(v) for v in re.split(r"[ ,]+", numbers.strip()) if v]
        if command == "Z":
            closed = True
            continue
        if command == "A":
            radius, radius_y, rotation, large, sweep, x, y = values
            if radius != radius_y or rotation != 0.0 or large != 0.0:
                raise ValueError(f"not an arc of at most a half turn: {numbers}")
            half = math.dist((vertices[-1][0], height - vertices[-1][1]), (x, y)) / 2.0
            angle = 2.0 * math.asin(min(1.0, half / radius))
            bulge = math.tan(angle / 4.0) * (-1.0 if sweep else 1.0)
            vertices[-1] = (*vertices[-1][:2], bulge)
        elif command in ("M", "L"):
            x, y = values
        else:
            raise ValueError(f"path command {command}")
        vertices.append((x, height - y, 0.0))
    # A closed path whose last segment is an arc comes back to its first point before the Z.
    if closed and math.dist(vertices[0][:2], vertices[-1][:2]) <= SAME_POINT:
        vertices.pop()
    return Path(element.get("class").upper(), vertices, closed)
