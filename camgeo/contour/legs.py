"""The legs of a path: the stretches between its corners, each fitted and proved on its own.

A leg is a stretch of a parallel over the cam angle, or the arc of a turn about a point over the
angle turned. Fit and proof treat both alike: a curve Z over a parameter with bounds of its
derivatives, and a signed distance at which the path is its parallel; an arc is its own Z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.curve.circles import arc_pieces, centres_at
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.outline.path import Path, Pivot, Stretch
from camgeo.units import TURN

SNAP = 8.0 * math.ulp(TURN)
"""Two cam angles [rad] closer than this are the same, rounded differently."""

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a point, as a fraction of the lengths that it is computed from."""


@dataclass(frozen=True, slots=True)
class StretchLeg:
    """A stretch of a parallel as a leg; t is the cam angle.

    Attributes
    ----------
    curve : the parallel.
    start, end : range of t [rad], start < end.
    closed : True if it is a whole path that closes without a corner; it may then begin anywhere.
    first : its start [mm], shared with the leg before it; None where its own point is used.
    """

    curve: WorkingCurve
    start: float
    end: float
    closed: bool
    first: complex | None

    @property
    def distance(self) -> float:
        """d [mm], signed, of the leg from its Z."""
        return self.curve.distance

    @property
    def rotation(self) -> int:
        """sigma; the outward normal is i sigma Z'/|Z'|."""
        return self.curve.pitch.rotation

    @property
    def borders(self) -> FloatArray:
        """(k,) t at which the formula of Z changes, in [0, end] at least."""
        return np.concatenate((self.curve.borders, self.curve.borders + TURN))

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Its smooth pieces, in order; neighbours on one circle are one."""
        if self.closed:
            return arc_pieces(self.curve)
        found = []
        for turn in (-TURN, 0.0, TURN):
            for piece in arc_pieces(self.curve):
                start, end = piece.start + turn, piece.end + turn
                if min(end, self.end) - max(start, self.start) <= SNAP:
                    continue
                start = self.start if start < self.start + SNAP else start
                end = self.end if end > self.end - SNAP else end
                found.append(Piece(start, end, piece.centre))
        return tuple(found)

    def point(self, t: FloatArray, side: Side = "right") -> ComplexArray:
        """(n,) complex [mm] points at `t` (n,)."""
        return self.curve.point(t, side)

    def traced(self, t: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """(n,) points [mm], unit tangents of Z, and ds/dt [mm/rad] along the leg, negative where it
        runs against its tangent.
        """
        return self.curve.traced(t)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """(3 or more, n) complex [mm/rad^k] Z, Z', Z'' in the middle of cells [low, high] (n,), and
        (3, n) upper bounds of |Z'|, |Z''|, |Z'''| over them; no border lies inside a cell, so that
        none reaches across cam angle 0.
        """
        turns = TURN * np.floor(0.5 * (low + high) / TURN)
        return self.curve.pitch.jet_and_bounds(
            np.maximum(low - turns, 0.0), np.minimum(high - turns, TURN)
        )

    def poles(self, t: FloatArray) -> ComplexArray:
        """(n,) complex [mm] the point about which Z turns, with t as the angle, all along the
        stretch without a border that `t` (n,) lies in; NaN where it is not known to.
        """
        return centres_at(self.curve.pitch, t)


@dataclass(frozen=True, slots=True)
class TurnLeg:
    """The arc of a pivot as a leg; t is the angle turned, and the interface is that of
    `StretchLeg`.

    Attributes
    ----------
    centre, first, last : centre, start and end of the arc [mm].
    sweep : angle of the arc [rad], counter-clockwise positive.
    """

    centre: complex
    first: complex
    last: complex
    sweep: float
    start: float = 0.0
    closed: bool = False
    distance: float = 0.0
    rotation: int = 1

    @property
    def end(self) -> float:
        """See `StretchLeg`."""
        return abs(self.sweep)

    @property
    def radius(self) -> float:
        """Radius of the arc [mm]."""
        return abs(self.first - self.centre)

    @property
    def length(self) -> float:
        """Length of the arc [mm]."""
        return self.radius * self.end

    @property
    def borders(self) -> FloatArray:
        """See `StretchLeg`."""
        return np.empty(0)

    def point(self, t: FloatArray, side: Side = "right") -> ComplexArray:
        """See `StretchLeg`."""
        return self.centre + self._arm(t)

    def traced(self, t: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """See `StretchLeg`."""
        arm = self._arm(t)
        tangents = 1j * math.copysign(1.0, self.sweep) * arm / self.radius
        return self.centre + arm, tangents, np.full(len(t), self.radius)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """See `StretchLeg`."""
        arm = self._arm(0.5 * (low + high))
        jet = np.stack((self.centre + arm, 1j * math.copysign(1.0, self.sweep) * arm, -arm))
        return jet, np.full((3, len(low)), self.radius)

    def poles(self, t: FloatArray) -> ComplexArray:
        """See `StretchLeg`: its centre."""
        return np.full(len(t), self.centre)

    def _arm(self, t: FloatArray) -> ComplexArray:
        turned: ComplexArray = np.exp(1j * math.copysign(1.0, self.sweep) * t)
        turned *= self.first - self.centre
        return turned


Leg = StretchLeg | TurnLeg


def legs_of(path: Path) -> tuple[Leg, ...]:
    """The legs of a path, in order; corners are where they meet.

    Raises
    ------
    GeometryError
        If the path has no stretch.
    UndercutError
        If an arc has turned inside out: the parallel is farther off than a concave part of the path
        allows.
    """
    if not path.stretches:
        raise GeometryError("a path needs a stretch of the curve")
    legs: list[Leg] = []
    before = path.elements[-1]
    for element in path.elements:
        if isinstance(element, Stretch):
            if element.end - element.start <= SNAP:
                continue
            start = before.end if isinstance(before, Pivot) else None
            legs.append(StretchLeg(element.curve, element.start, element.end, path.is_whole, start))
        else:
            legs += _turn(element, path.stretches[0].curve.pitch.rotation)
        before = element
    return tuple(legs)


def _turn(pivot: Pivot, rotation: int) -> list[TurnLeg]:
    """The arc of a pivot, or none if it is a corner."""
    size = abs(pivot.centre) + abs(pivot.distance)
    if abs(pivot.distance * pivot.sweep) <= ROUNDING * size:
        return []
    # The direction of travel is t = n/(i sigma); along the arc it is i distance n, in the sense of
    # the sweep.
    if pivot.distance * pivot.sweep * rotation > 0.0:
        raise UndercutError(
            f"the arc about a corner at cam angle {math.degrees(pivot.before):.6g} degrees has"
            " turned inside out: the parallel is too far on the concave side"
        )
    return [TurnLeg(pivot.centre, pivot.start, pivot.end, pivot.sweep)]
