"""A profile curve over its arc length, with the nearest place to points beside it."""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import KDTree

from .body import Floats
from .iteration import NotConverged

SAMPLE = 0.1e-3
"""Distance of the places from which the nearest one is sought, m."""
ROUNDS = 30
"""Most steps of Newton's method for a nearest place."""
PLACE_END = 1e-12
"""Change of a place that ends them, m."""
STRIDE = 0.2e-3
"""Longest step of Newton's method, m: one that leaves the neighbourhood would find another place."""


class Curve:
    """A profile (y, z) as a cubic spline over arc length; a right-handed turn by 90 degrees of its tangent, which goes
    to the field side, points down (z)."""

    def __init__(self, points: Floats) -> None:
        chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        self.length = float(chord[-1])
        self._spline = CubicSpline(chord, points)
        self._slope = self._spline.derivative()
        self._bend = self._slope.derivative()
        self._places = np.linspace(0.0, self.length, 1 + int(np.ceil(self.length / SAMPLE)))
        self._tree = KDTree(self._spline(self._places))

    def at(self, s: Floats) -> Floats:
        """Points (y, z), one row a place, m."""
        return self._spline(s)

    def tangent(self, s: Floats) -> Floats:
        """Unit tangents towards the field side."""
        t = self._slope(s)
        return t / np.linalg.norm(t, axis=1, keepdims=True)

    def nearest(self, points: Floats) -> Floats:
        """Arc lengths nearest to points (y, z), within the curve, m."""
        s = self._places[self._tree.query(points)[1]]
        for _ in range(ROUNDS):
            t = self._slope(s)
            off = self._spline(s) - points
            first = np.einsum("pi,pi->p", off, t)
            second = np.einsum("pi,pi->p", t, t) + np.einsum("pi,pi->p", off, self._bend(s))
            step = np.where(second > 0.0, -first / np.where(second > 0.0, second, 1.0), -np.sign(first) * STRIDE)
            after = np.clip(s + np.clip(step, -STRIDE, STRIDE), 0.0, self.length)
            change = float(np.abs(after - s).max(initial=0.0))
            s = after
            if change < PLACE_END:
                return s
        raise NotConverged("nearest place on a profile", ROUNDS, change, PLACE_END, "m", len(points))
