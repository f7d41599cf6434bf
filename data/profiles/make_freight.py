#!/usr/bin/env python3
"""Writes a worn freight wheel and a worn rail beside this file, as if they had been measured. No standard of railspring is like them.

The wheel has the public dimensions of North American freight wheels: flange, throat of two radii, tread of 1:20. Its flange face is
worn by 1 mm. It is written as a MiniProf file. The rail has a head of the dimensions of AREMA 136: crown of
254 mm, shoulder of 32 mm, corner of 9.5 mm. Its crown is worn by 1.5 mm and its gauge side by 1 mm. It is written as columns of text.
Both are drawn from these dimensions, not measured, and where the wear lies is chosen. Points are 0.25 mm apart and scatter by
2 micrometres. The same files come out on every machine.
"""

import math
from pathlib import Path

from make_worn import even, scattered

DRAWN = 0.02  # mm, longest step of a drawn line

# mm: slope and end of the tread, end of the rim, thickness of the flange 10 mm above the tape circle, radii of the throat at tread and flange,
# inclination of the face (degrees), height of the flange, radii of its tip outside and inside, tape circle from the flange back
WHEEL = {"slope": 0.05, "rim": 68.0, "thickness": 31.0, "throat": (38.0, 14.3), "face": 75.0, "flange": 25.4, "tip": (17.5, 12.0), "tape": 72.2}
# mm: width 14 mm below the top; crown radius, half width at which the crown ends, shoulder radius; corner radius; inclination and depth of the side
RAIL = {"head": 74.6, "crown": (254.0, 19.0, 32.0), "corner": 9.5, "side": 0.025, "depth": 38.0}
FLANGE_WEAR, CROWN_WEAR, SIDE_WEAR = 1.0, 1.5, 1.0  # mm


class Pen:
    """Straight pieces and arcs that follow each other tangentially; the angle is from y towards z."""

    def __init__(self, angle):
        self.points, self.angle = [(0.0, 0.0)], angle

    def straight(self, length):
        y, z = self.points[-1]
        count = max(math.ceil(length / DRAWN), 1)
        along = [length * i / count for i in range(1, count + 1)]
        self.points += [(y + s * math.cos(self.angle), z + s * math.sin(self.angle)) for s in along]

    def arc(self, radius, to):
        (y, z), turn = self.points[-1], to - self.angle
        side = math.copysign(1.0, turn)
        centre = (y - side * radius * math.sin(self.angle), z + side * radius * math.cos(self.angle))
        count = max(math.ceil(radius * abs(turn) / DRAWN), 1)
        for angle in [self.angle + turn * i / count for i in range(1, count + 1)]:
            self.points.append((centre[0] + side * radius * math.sin(angle), centre[1] - side * radius * math.cos(angle)))
        self.angle = to

    def arc_across(self, radius, y):
        self.arc(radius, math.asin(math.sin(self.angle) + (y - self.points[-1][0]) / radius))


def bisected(low, high, is_below):
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_below(middle) else (low, middle)
    return low


def head():
    """The head from the gauge to the field side, its top at the origin."""
    slope = math.pi / 2 - math.atan(RAIL["side"])

    def half(shoulder):
        pen = Pen(0.0)
        crown, end, side = RAIL["crown"]
        pen.arc_across(crown, min(end, shoulder))
        if shoulder > end:
            pen.arc_across(side, shoulder)
        pen.arc(RAIL["corner"], slope)
        pen.straight((RAIL["depth"] - pen.points[-1][1]) / math.sin(slope))
        return pen.points

    def is_narrow(shoulder):
        return 2.0 * next(y for y, z in half(shoulder) if z >= 14.0) < RAIL["head"]

    right = half(bisected(0.2 * RAIL["head"], 0.5 * RAIL["head"], is_narrow))
    return [(-y, z) for y, z in reversed(right)] + right[1:]


def wheel():
    """The profile from the flange back to the end of the tread, the tape circle at the origin."""
    tread, face = math.atan(WHEEL["slope"]), math.radians(WHEEL["face"])
    outer_tip, inner_tip = WHEEL["tip"]

    def to_back(straight):
        """From the tape circle over the flange to its back, y towards the back."""
        pen = Pen(tread)
        pen.straight(straight)
        pen.arc(WHEEL["throat"][0], tread + min(0.35 * (face - tread), math.radians(10.0)))
        pen.arc(WHEEL["throat"][1], face)
        rise = outer_tip * (1.0 - math.cos(face))
        pen.straight((WHEEL["flange"] - rise - pen.points[-1][1]) / math.sin(face))
        pen.arc(outer_tip, 0.0)
        tip = len(pen.points) - 1
        pen.arc(inner_tip, -math.pi / 2)
        pen.straight(10.0)
        return pen.points, tip

    def is_thick(straight):
        return WHEEL["tape"] - next(y for y, z in to_back(straight)[0] if z >= 10.0) > WHEEL["thickness"]

    points, tip = to_back(bisected(0.1, WHEEL["tape"], is_thick))
    # the back comes to its distance from the tape circle: the tip is stretched or pressed level
    at, factor = points[tip][0], (WHEEL["tape"] - points[tip][0]) / (points[-1][0] - points[tip][0])
    points = points[: tip + 1] + [(at + factor * (y - at), z) for y, z in points[tip + 1 :]]
    outer = Pen(-tread)
    outer.straight(WHEEL["rim"] / math.cos(tread))
    return [(-y, z) for y, z in reversed(points)] + outer.points[1:]


def worn_wheel(profile):
    tip = max(profile, key=lambda point: point[1])
    worn = []
    for y, z in profile:
        part = min(max(z / tip[1], 0.0), 1.0) if y > tip[0] + 2.0 and z > 1.0 else 0.0
        worn.append((y - FLANGE_WEAR * math.sin(math.pi * part), z))
    return worn


def worn_head(profile):
    width = max(abs(y) for y, _ in profile)
    worn = []
    for y, z in profile:
        share = max(1.0 - ((y + 0.2 * width) / (1.1 * width)) ** 2, 0.0)
        gauge = min(max(-y / width - 0.55, 0.0), 0.45) / 0.45
        side = SIDE_WEAR * gauge * gauge * (3.0 - 2.0 * gauge)
        worn.append((y + side, z + CROWN_WEAR * share * (1.0 - min(max(z / 20.0, 0.0), 1.0))))
    return worn


def main():
    here = Path(__file__).parent
    measured = scattered(even(worn_wheel(wheel())), 3)
    # MiniProf: X from the flange back, Y towards the tip
    rows = "".join(f"{y + WHEEL['tape']:.4f}\t{z:.4f}\n" for y, z in measured)
    heading = f"Filename=freight.whl\nProgramName=make_freight.py\nXYPoints={len(measured)}\nXOffset=0.0000\nYOffset=0.0000\nColumnDef=X,Y\n\n"
    (here / "freight.whl").write_text(heading + rows, newline="\n")
    rows = "".join(f"{y:.4f};{z:.4f}\n" for y, z in scattered(even(worn_head(head())), 4))
    (here / "freight-rail.csv").write_text("# worn head, y to the field side, z down\ny_mm;z_mm\n" + rows, newline="\n")


if __name__ == "__main__":
    main()
