"""Prints what a cut file holds, as one line of JSON: cut_summary.py cut.dxf | cut.svg

Exit status 1 where a DXF needs a fix, has an error, or is not in millimetres.
"""

import json
import sys
from collections import Counter

from cut_file import read_dxf, read_svg


def describe(paths):
    lengths = Counter()
    for path in paths:
        lengths[path.layer] += path.length()
    arcs = sum(1 for path in paths for _, _, bulge in path.segments() if bulge != 0.0)
    shown = [{"layer": p.layer, "closed": p.closed, "vertices": p.vertices, "length": p.length()} for p in paths]
    return {"lengths": lengths, "arcs": arcs, "paths": shown}


def dxf_summary(name):
    document, auditor, paths, reasons = read_dxf(name)
    header = document.header
    layers = {
        layer.dxf.name: {"color": layer.dxf.color, "plot": layer.dxf.get("plot", None)} for layer in document.layers
    }
    entities = Counter(f"{entity.dxftype()} {entity.dxf.layer}" for entity in document.modelspace())
    texts = [entity.dxf.text for entity in document.modelspace().query("TEXT")]
    return {
        "version": document.dxfversion,
        "insunits": header.get("$INSUNITS"),
        "measurement": header.get("$MEASUREMENT"),
        "errors": len(auditor.errors),
        "fixes": len(auditor.fixes),
        "reasons": reasons,
        "layers": layers,
        "entities": entities,
        "texts": texts,
        **describe(paths),
    }


def svg_summary(name):
    size, paths, texts = read_svg(name)
    return {"size": size, "texts": texts, "reasons": [], **describe(paths)}


def main():
    name = sys.argv[1]
    summary = svg_summary(name) if name.endswith(".svg") else dxf_summary(name)
    print(json.dumps(summary))
    sys.exit(1 if summary["reasons"] else 0)


if __name__ == "__main__":
    main()
