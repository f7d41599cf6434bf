#!/usr/bin/env python3
"""Writes a worn wheel and a worn rail beside this file, as if they had been measured.

Wheel: S1002 with a tread worn hollow by 2 mm and a flange worn by 3 mm (thickness 29.5 instead of 32.5 mm,
10 mm below the tape circle), as a MiniProf file. Rail: 60E1 with a crown worn by 1.5 mm and a gauge corner worn
by 0.5 mm at a depth of 7 mm, as a Simpack file. Both are generated from the standards'
definitions (README.md); where the wear lies is chosen, not measured. Points are 0.25 mm apart and scatter by
2 micrometres, as those of a good gauge do. The same files come out on every machine.
"""

import math
from pathlib import Path

STEP = 0.25  # mm, distance of the points
SCATTER = 0.002  # mm, standard deviation

HOLLOW = {"depth": 2.0, "centre": 14.0, "half_width": 38.0}
FLANGE = {"depth": 3.0, "at": 10.0, "above": 9.5, "below": 26.0}
FLANGE_TIP = -55.0  # mm, where the wear of the flange has faded out ...
TIP_WIDTH = 8.0  # mm, ... and over which width
CROWN = {"depth": 1.5, "half_width": 34.0}
GAUGE_CORNER = {"depth": 0.5, "at": 7.0, "above": 7.0, "below": 12.0}

ZONE_B = [0.0, -3.358537058e-2, 1.565681624e-3, -2.810427944e-5, 5.844240864e-8, -1.562379023e-8,
          5.309217349e-15, -5.957839843e-12, 2.646656573e-13]
ZONE_C = [-4.320221063e3, -1.038384026e3, -1.065501873e2, -6.051367875, -2.054332446e-1, -4.169739389e-3,
          -4.687195829e-5, -2.252755540e-7]


def polynomial(coefficients, y):
    return sum(c * y**k for k, c in enumerate(coefficients))


def s1002(y):
    """Height z (down) in mm at y from the tape circle."""
    if y < -62.764705882:
        return 9.519259302 + math.sqrt(20.5**2 - (y + 49.5) ** 2)
    if y < -49.662510381:
        return 16.0 + math.sqrt(12.0**2 - (y + 55.0) ** 2)
    if y < -39.764473993:
        return 8.83492413 + math.sqrt(20.0**2 - (y + 58.558326413) ** 2)
    if y < -38.426669071:
        return -93.576667419 - 2.747477419 * y
    if y < -35.0:
        return 16.446 - math.sqrt(13.0**2 - (y + 26.210665) ** 2)
    if y < -26.0:
        return polynomial(ZONE_C, y)
    if y < 32.15796:
        return polynomial(ZONE_B, y)
    return 1.36432364 - 0.066666667 * y


def rail_60e1(y):
    """Height z (down) in mm of the head at y from the axis, without its straight sides."""
    y = abs(y)
    if y < 10.228:
        return 300.0 - math.sqrt(300.0**2 - y**2)
    if y < 26.0265:
        return 80.1279 - math.sqrt(80.0**2 - (y - 7.5005) ** 2)
    return 14.9491 - math.sqrt(max(13.0**2 - (y - 23.0160) ** 2, 0.0))


def bump(t):
    """1 at t = 0, and 0 with its slope from |t| = 1 on."""
    return (1.0 - t * t) ** 2 if abs(t) < 1.0 else 0.0


def side_bump(z, wear):
    """Share of the wear of a side at the depth z."""
    return bump((z - wear["at"]) / (wear["above"] if z < wear["at"] else wear["below"]))


def even(points):
    """Points STEP apart along a dense line."""
    taken, travelled, due = [points[0]], 0.0, STEP
    for a, b in zip(points, points[1:]):
        length = math.dist(a, b)
        while travelled + length >= due:
            t = (due - travelled) / length
            taken.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))
            due += STEP
        travelled += length
    return taken


def scattered(points, seed):
    """Adds normally distributed numbers from a linear congruential generator."""
    state = seed

    def normal():
        nonlocal state
        total = 0.0
        for _ in range(12):
            state = (6364136223846793005 * state + 1442695040888963407) % 2**64
            total += (state >> 11) / 2**53
        return SCATTER * (total - 6.0)

    return [(y + normal(), z + normal()) for y, z in points]


def worn_wheel():
    points = []
    for i in range(128_501):
        y = -69.0 + i * 0.001
        z = s1002(y)
        hollow = HOLLOW["depth"] * bump((y - HOLLOW["centre"]) / HOLLOW["half_width"])
        t = min(max((y - FLANGE_TIP) / TIP_WIDTH, 0.0), 1.0)
        flange = FLANGE["depth"] * side_bump(z, FLANGE) * t * t * (3.0 - 2.0 * t) if y < -10.0 else 0.0
        points.append((y - flange, z - hollow))
    return scattered(even(points), 1)


def worn_rail():
    head = [(i * 0.001, rail_60e1(i * 0.001)) for i in range(36_000)]
    depths = [14.3 + i * 0.005 for i in range(2941)]
    half = head + [(36.0 + (z - 14.3) / 20.0, z) for z in depths]
    points = []
    for y, z in [(-y, z) for y, z in reversed(half)] + half[1:]:
        crown = CROWN["depth"] * bump(y / CROWN["half_width"])
        face = GAUGE_CORNER["depth"] * side_bump(z, GAUGE_CORNER) if y < 0.0 else 0.0
        points.append((y + face, z + crown))
    return scattered(even(points), 2)


def main():
    here = Path(__file__).parent
    wheel = worn_wheel()
    # MiniProf: X from the flange back, Y towards the tip.
    rows = "".join(f"{y + 70.0:.4f}\t{z:.4f}\n" for y, z in wheel)
    header = (f"Filename=worn-s1002.whl\nProgramName=make_worn.py\nXYPoints={len(wheel)}\nXOffset=0.0000\n"
              "YOffset=0.0000\nColumnDef=X,Y\n\n")
    (here / "worn-s1002.whl").write_text(header + rows, newline="\n")
    rail = worn_rail()
    rows = "".join(f"{y:.4f}\t{z:.4f}\n" for y, z in rail)
    header = ("header.begin\n  version = 1\n  type = 0 ! rail\nheader.end\nspline.begin\n  approx.smooth = 0\n"
              "  comment = 'worn 60E1, made by make_worn.py'\n  units.len.f = 1000 ! mm\n  units.ang.f = 1\n"
              "  point.begin\n")
    (here / "worn-60e1.prr").write_text(header + rows + "  point.end\nspline.end\n", newline="\n")


if __name__ == "__main__":
    main()
