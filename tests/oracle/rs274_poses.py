"""Poses of the tool from the canonical motions that LinuxCNC's stand-alone interpreter prints.

Usage: rs274_poses.py KIND TCP ZERO TURN_CENTRE TILT_CENTRE < canonical > poses
KIND is xyzac-trt, xyzbc-trt, xyzab-tdr or xyz; TCP the value of analog output 3 that holds the tip, or "never"; places are x,y,z
in millimetres, machine coordinates. The formulas are LinuxCNC's own (trtfuncs.c, xyzab_tdr_kins.comp), typed term by
term: nothing here comes from the program under test. Each line of the result: x y z of the tip and i j k of the axis on the part,
r for rapid or f for feed, spindle speed.
"""

import math
import re
import sys

kind, tcp_value = sys.argv[1:3]
zero, turn_centre, tilt_centre = ([float(v) for v in word.split(",")] for word in sys.argv[3:6])


def axis(tilt, turn):
    st, ct, sc, cc = math.sin(tilt), math.cos(tilt), math.sin(turn), math.cos(turn)
    if kind == "xyzac-trt":
        return [sc * st, cc * st, ct]
    if kind == "xyzbc-trt":
        return [-cc * st, sc * st, ct]
    if kind == "xyzab-tdr":
        return [st, -sc * ct, cc * ct]
    return [0.0, 0.0, 1.0]


def forward(x, y, z, tilt, turn):
    """From joints to the table, both in machine coordinates with the tool's length taken off."""
    st, ct, sc, cc = math.sin(tilt), math.cos(tilt), math.sin(turn), math.cos(turn)
    if kind == "xyz":
        return [x, y, z]
    if kind == "xyzab-tdr":
        xr, yr, zr = tilt_centre
        dz = turn_centre[2] - zr
        px, py, pz = x - xr, y - yr, z - zr
        return [
            ct * px + st * pz + xr,
            sc * st * px + cc * py - ct * sc * pz + sc * dz + yr,
            -cc * st * px + sc * py + cc * ct * pz - cc * dz + zr + dz,
        ]
    xr, yr, zr = turn_centre
    dx, dy, dz = (tilt_centre[i] - turn_centre[i] for i in range(3))
    if kind == "xyzac-trt":
        px, py, pz = x - xr, y - dy - yr, z - dz - zr
        return [
            cc * px + sc * ct * py + sc * st * pz + sc * dy + xr,
            -sc * px + cc * ct * py + cc * st * pz + cc * dy + yr,
            -st * py + ct * pz + dz + zr,
        ]
    px, py, pz = x - dx - xr, y - yr, z - dz - zr
    return [
        cc * ct * px + sc * py - cc * st * pz + cc * dx + xr,
        -sc * ct * px + cc * py + sc * st * pz - sc * dx + yr,
        st * px + ct * pz + dz + zr,
    ]


held = False
speed = spindle = 0.0
ended = False
for line in sys.stdin:
    call = re.search(r"\b([A-Z_0-9]+)\((.*)\)\s*$", line)
    if not call or call.group(1) in ("COMMENT", "MESSAGE"):
        continue
    name = call.group(1)
    numbers = [float(v) for v in re.findall(r"-?\d+\.?\d*", call.group(2))] if name != "USE_LENGTH_UNITS" else []
    if name == "USE_LENGTH_UNITS":
        assert "MM" in call.group(2), line
    elif name == "SET_AUX_OUTPUT_VALUE":
        assert numbers[0] == 3, line
        held = tcp_value != "never" and numbers[1] == float(tcp_value)
    elif name == "SET_SPINDLE_SPEED":
        speed = numbers[-1]
    elif name == "START_SPINDLE_CLOCKWISE":
        spindle = speed
    elif name == "STOP_SPINDLE_TURNING":
        spindle = 0.0
    elif name == "PROGRAM_END":
        ended = True
    elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
        x, y, z, a, b, c = numbers[-6:]
        tilt = math.radians(a if kind == "xyzac-trt" else b)
        turn = math.radians(a if kind == "xyzab-tdr" else c)
        place = [x, y, z]
        if not held:
            joints = [place[i] + zero[i] for i in range(3)]
            place = [p - zero[i] for i, p in enumerate(forward(*joints, tilt, turn))]
        letter = "r" if name == "STRAIGHT_TRAVERSE" else "f"
        print(*(f"{v:.9f}" for v in place + axis(tilt, turn)), letter, spindle)
    elif name.startswith("ARC"):
        sys.exit(f"an arc: {line}")
if not ended:
    sys.exit("the program does not end")
