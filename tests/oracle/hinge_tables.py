"""Compares hinges.csv with hinges.json: hinge_tables.py hinges.json hinges.csv

Prints one line of JSON: the header, the number of rows, and the places ("hinge 3, strain: ...") where the CSV does not say
what the JSON says to the CSV's own digits.
"""

import csv
import json
import sys


def flattened(row):
    """The JSON row as (column, value) in the CSV's columns."""
    names = {"pieces": ["piece_j", "piece_k"], "point": ["x_mm", "y_mm", "z_mm"], "axis": ["axis_x", "axis_y", "axis_z"]}
    for key, value in row.items():
        yield from zip(names[key], value, strict=True) if key in names else [(key, value)]


def same(text, value):
    if value is None:
        return text == ""
    if isinstance(value, str):
        return text == value
    if isinstance(value, int):
        return text == str(value)
    decimals = len(text.partition(".")[2])
    # Half a unit of the last printed digit, and the rounding of the binary number.
    return 3 <= decimals <= 6 and abs(float(text) - value) <= 0.5000001 * 10.0**-decimals


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        rows = json.load(file)["hinges"]
    with open(sys.argv[2], encoding="utf-8", newline="") as file:
        text = file.read()
    header, *lines = csv.reader(text.splitlines(keepends=True), strict=True)
    faults = [] if text.endswith("\n") and "\r" not in text else ["line ends"]
    if len(rows) != len(lines):
        faults.append(f"{len(lines)} rows for {len(rows)} hinges")
    for row, line in zip(rows, lines):
        expected = list(flattened(row))
        if [column for column, _ in expected] != header or len(line) != len(header):
            faults.append(f"hinge {row['id']}: columns differ")
            continue
        faults += [
            f"hinge {row['id']}, {column}: {field} for {value}"
            for (column, value), field in zip(expected, line)
            if not same(field, value)
        ]
    print(json.dumps({"header": header, "rows": len(lines), "faults": faults}))


if __name__ == "__main__":
    main()
