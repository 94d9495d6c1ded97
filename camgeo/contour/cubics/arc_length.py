"""Smooth pieces of a curve over their arc length, and their difficulty for a spline.

All pieces of a path are evaluated in one call: the cost is in the calls, not in the points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.follower import bend_of_path
from camgeo.motion.motion import FULL_ORDER
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, Side, taken

CELLS = 160
"""Cells of cam angle per piece. The arc length is only a parameter: its error of some 1e-8 moves a
spline along the curve, not off it."""

NODES = np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
"""The three Gauss nodes in [-1, 1]."""

WEIGHTS = np.array([5.0, 8.0, 5.0]) / 9.0

SLOWEST = 1e-9
"""Smallest divisor 1 + d kappa; below it there is a cusp, where the difficulty is infinite at one
point."""

FLOOR = 0.02
"""Smallest density of knots, as a fraction of the piece's mean: every stretch gets knots."""

NEWTON = 4
"""Steps from the arc length to the cam angle, from a start within a cell."""


@dataclass(frozen=True, slots=True, eq=False)
class Traced:
    """One evaluation of a parallel at n cam angles, in arrays of one shape.

    Attributes
    ----------
    points, tangents : complex [mm], and unit in the direction of growing cam angle.
    speed : |Z'| of the pitch curve [mm/rad].
    regular : 1 + d kappa.
    bend : kappa of the pitch curve [1/mm].
    slope : dkappa/dphi of the pitch curve [1/(mm rad)].
    """

    points: ComplexArray
    tangents: ComplexArray
    speed: FloatArray
    regular: FloatArray
    bend: FloatArray
    slope: FloatArray

    @classmethod
    def of(cls, curve: WorkingCurve, phi: FloatArray, side: Side = "right") -> Traced:
        """The evaluation at `phi` (n,) [rad], in one call."""
        pitch = curve.pitch
        relative = pitch.relative_jet(phi, side)
        speed = pitch.speed(relative)
        jet = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        tangents = jet[1] / speed
        points = jet[0] + (1j * pitch.rotation * curve.distance) * tangents
        bend = bend_of_path(relative, speed, pitch.rotation)
        if len(relative.along) <= FULL_ORDER:  # a flat face has no R_3
            slope = pitch.curvature_slope(phi, side)
        else:
            (_, a1, a2, a3), (_, b1, b2, b3) = relative.along, relative.across
            cube = speed * speed * speed
            growth = (a1 * a2 + b1 * b2) / (speed * speed)
            slope = pitch.rotation * (b1 * a3 - a1 * b3) / cube - 3.0 * bend * growth
        return cls(points, tangents, speed, 1.0 + curve.distance * bend, bend, slope)

    def shaped(self, which: slice, shape: tuple[int, ...]) -> Traced:
        """The part `which` of all arrays, reshaped."""
        part = taken(self, which)
        return Traced(*(getattr(part, each.name).reshape(shape) for each in fields(part)))


@dataclass(frozen=True, slots=True, eq=False)
class ArcLength:
    """Smooth pieces of one parallel, end to end on one line of arc length S.

    Piece k is S in [ends[k], ends[k + 1]] [mm]; its cells of cam angle are uniform.

    Attributes
    ----------
    curve : the parallel.
    phi : (pieces, CELLS + 1) cam angles [rad] of the cells' ends.
    s : (pieces, CELLS + 1) arc length S [mm] there.
    points, tangents : (pieces, CELLS + 1) complex, there [mm] and unit.
    pace : (pieces, CELLS, 3) ds/dphi [mm/rad] at Gauss's nodes.
    density : (pieces, CELLS) difficulty |kappa'' - kappa^3|^(1/4) [1/mm] of each cell.
    """

    curve: WorkingCurve
    phi: FloatArray
    s: FloatArray
    points: ComplexArray
    tangents: ComplexArray
    pace: FloatArray
    density: FloatArray

    @classmethod
    def of(
        cls,
        curve: WorkingCurve,
        phi: FloatArray,
        points: ComplexArray,
        tangents: ComplexArray,
        inside: Traced,
    ) -> ArcLength:
        """From the curve at the cells' ends and, `inside`, at the nodes: see `cells_of`.

        The pieces must be regular, except for cusps at single points.
        """
        half = 0.5 * (phi[:, -1:] - phi[:, :1]) / CELLS
        regular = np.maximum(inside.regular, SLOWEST)
        pace = inside.speed * regular
        steps = half * (pace @ WEIGHTS)
        lengths = np.sum(steps, axis=1)
        ends = np.concatenate(([0.0], np.cumsum(lengths)))
        s = np.concatenate((np.zeros_like(half), np.cumsum(steps, axis=1)), axis=1)
        # The two curvatures of a parallel: kappa_d = kappa/(1 + d kappa), and its slope over s_d.
        slope = inside.slope / (pace * regular * regular)
        kappa = inside.bend[..., 1] / regular[..., 1]
        apart = half * (pace[..., 0] + pace[..., 2]) * 0.5 * (NODES[2] - NODES[0])
        second = (slope[..., 2] - slope[..., 0]) / apart
        density = np.sqrt(np.sqrt(np.abs(second - kappa**3)))
        return cls(curve, phi, s + ends[:-1, None], points, tangents, pace, density)

    @property
    def ends(self) -> FloatArray:
        """(pieces + 1,) S [mm] at the ends of the pieces."""
        return np.append(self.s[:, 0], self.s[-1, -1])

    @property
    def totals(self) -> FloatArray:
        """(pieces,) integral of the difficulty over each piece."""
        totals: FloatArray = np.sum(self.density * np.diff(self.s, axis=1), axis=1)
        return totals

    @property
    def shares(self) -> FloatArray:
        """(pieces, CELLS + 1) share of the difficulty up to each cell's end, from 0 to 1, floored;
        evenly along a piece without any.
        """
        steps = np.diff(self.s, axis=1)
        lengths = np.sum(steps, axis=1, keepdims=True)
        work = self.density * steps
        total = np.sum(work, axis=1, keepdims=True)
        least = np.where(total > 0.0, FLOOR * total, 1.0) / lengths
        sums = np.cumsum(work + least * steps, axis=1)
        shares = np.concatenate((np.zeros_like(lengths), sums / sums[:, -1:]), axis=1)
        shares[:, -1] = 1.0
        return shares

    def angles(self, piece: IntArray, s: FloatArray) -> FloatArray:
        """(n,) cam angles [rad] at the arc lengths S `s` (n,) [mm] of the pieces `piece` (n,)."""
        flat = self.s[:, :-1].ravel()
        cell = self._cells(piece, s)
        pace = self.pace.reshape(-1, 3)[cell]
        # Pace as a parabola a + b x + c x^2 over x in [-1, 1]; its integral is the arc length.
        a = pace[:, 1]
        b = (pace[:, 2] - pace[:, 0]) / (2.0 * NODES[2])
        c = (0.5 * (pace[:, 2] + pace[:, 0]) - a) / (NODES[2] * NODES[2])
        low = self.phi[:, :-1].ravel()[cell]
        first, whole = self.phi[:, 1] - self.phi[:, 0], self.phi[:, -1] - self.phi[:, 0]
        # The cells of a piece of some ulps are no longer apart.
        half = 0.5 * np.where(first > 0.0, first, whole / CELLS)[piece]
        wanted = (s - flat[cell]) / half
        x = np.clip(wanted / a - 1.0, -1.0, 1.0)
        for _ in range(NEWTON):
            reached = a * (x + 1.0) + b * (x * x - 1.0) / 2.0 + c * (x * x * x + 1.0) / 3.0
            slope = np.maximum(a + x * (b + x * c), 1e-3 * a)
            x = np.clip(x + (wanted - reached) / slope, -1.0, 1.0)
        return low + half * (x + 1.0)

    def near(self, piece: IntArray, s: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) complex points [mm] and approximate unit tangents at S `s` (n,) [mm].

        By cubics between the cells' ends: for spans of at least four cells the cubics are off by
        less than a hundredth of what a spline of such spans is. Costs no evaluation.
        """
        cell = self._cells(piece, s)
        place = cell + cell // CELLS  # of the cell's start among the cells' ends
        flat, points, tangents = self.s.ravel(), self.points.ravel(), self.tangents.ravel()
        low, first, last = flat[place], points[place], points[place + 1]
        step = flat[place + 1] - low
        t = (s - low) / step
        leave, arrive = step * tangents[place], step * tangents[place + 1]
        chord = last - first
        bow, lean = leave - chord, arrive - chord
        w = 1.0 - t
        at = first + t * chord + (t * w) * (w * bow - t * lean)
        along = chord + (w * (1.0 - 3.0 * t)) * bow + (t * (3.0 * t - 2.0)) * lean
        return at, along / step

    def _cells(self, piece: IntArray, s: FloatArray) -> IntArray:
        """(n,) number of the cell that each `s` (n,) of the pieces `piece` (n,) lies in."""
        cell = np.searchsorted(self.s[:, :-1].ravel(), s, side="right") - 1
        return np.minimum(np.maximum(cell, piece * CELLS), piece * CELLS + (CELLS - 1))


def cells_of(pieces: Sequence[Piece]) -> tuple[FloatArray, FloatArray]:
    """(pieces, CELLS + 1) and (pieces, CELLS, 3) cam angles [rad] of cells' ends and nodes."""
    start = np.array([piece.start for piece in pieces])[:, None]
    end = np.array([piece.end for piece in pieces])[:, None]
    phi = start + (end - start) * (np.arange(CELLS + 1) / CELLS)
    phi[:, -1:] = end
    middle = 0.5 * (phi[:, :-1] + phi[:, 1:])
    half = 0.5 * (end - start) / CELLS
    return phi, middle[..., None] + half[..., None] * NODES


def require_finite(course: ArcLength) -> None:
    """Raise GeometryError if the curve stands still or its difficulty is not finite."""
    if not np.all(np.isfinite(course.s)) or np.any(np.diff(course.s, axis=1) <= 0.0):
        raise GeometryError("the curve stands still: no spline over its arc length can be made")
    if not np.all(np.isfinite(course.totals)):
        raise GeometryError("the curvature of the curve is infinite on a stretch of it")
