"""Replay of a roller on a contour of cubic splines, arcs and lines.

The roller centre runs on the contour's parallel at the roller radius. That of a cubic has no closed
form: the parameter at which the roller touches it is found by Newton's method to rounding, and the
lift and its derivatives follow from the curvature of the parallel there and its change along it.

All parallels together, with the arcs about the corners that turn out, are one chain. If the cam
angle runs one way along each of them, the chain is the graph of a lift over the cam angle, so no
other part of it holds the roller; else the replay is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.geometry.outline.path import Flank
from camgeo.geometry.outline.replay import CORNER, STEP, Replay, compared
from camgeo.geometry.outline.roller import ActualLift, Branches, Parallel, branches, cut
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.follower_path import Bows, FollowerPath, lift_jet, path_of
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, dot, joined
from camgeo.units import TURN

STEPS: Final = 30
"""Most Newton steps; five are already many."""

SETTLED: Final = 64.0 * 2.0**-52 * TURN
"""A step that changes the cam angle by less than this [rad], a few roundings, is the last one."""

BEYOND: Final = 0.1
"""Parameters that far beyond a cubic are still tried."""

LOOKS: Final = 33
"""Parameters of each cubic at which its parallel is looked at: whether it is regular and the cam
angle runs one way. This is sampled, not proved; cubics of a fit turn by little."""

GAP: Final = 1e-9
"""Neighbouring branches meet within this cam angle [rad]: the rounding of their ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Cubics:
    """Parallels of cubic Bezier pieces.

    Attributes
    ----------
    pieces : (n, 4) complex [mm] Bezier points.
    distance : of the parallels [mm], positive to the right-hand side.
    """

    pieces: ComplexArray
    distance: float

    def traced(
        self, index: IntArray, t: FloatArray
    ) -> tuple[ComplexArray, ComplexArray, FloatArray, FloatArray, FloatArray]:
        """Point, unit normal on the right, pace ds/dt, curvature [1/mm] and its change along the
        curve [1/mm^2] of the parallels `index` (n,) at `t` (n,).

        A parallel at d has the pace (1 + d kappa) times that of its curve, and the curvature
        kappa/(1 + d kappa).
        """
        b = self.pieces[index]
        w = 1.0 - t
        sides = 3.0 * np.diff(b, axis=1)
        bends = 2.0 * np.diff(sides, axis=1)
        point = (
            w**3 * b[:, 0] + 3.0 * w * w * t * b[:, 1] + 3.0 * w * t * t * b[:, 2] + t**3 * b[:, 3]
        )
        first = w * w * sides[:, 0] + 2.0 * w * t * sides[:, 1] + t * t * sides[:, 2]
        second = w * bends[:, 0] + t * bends[:, 1]
        third = bends[:, 1] - bends[:, 0]
        speed = np.abs(first)
        cross = (first.conj() * second).imag
        kappa = cross / speed**3
        grown = (first.conj() * third).imag / speed**3 - 3.0 * kappa * dot(first, second) / speed**2
        share = 1.0 + self.distance * kappa
        normal = -1j * first / speed
        return (
            point + self.distance * normal,
            normal,
            speed * share,
            kappa / share,
            grown / (speed * share**3),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """What the roller runs on, see `camgeo.geometry.outline.roller.Touched`: arcs, then cubics.

    Attributes
    ----------
    arcs : branches of lines and arcs.
    cubics : the others.
    starts, ends : (m,) cam angles [rad] at the parameters 0 and 1 of the cubics, each less than
        half a turn from the other, of any turn.
    elements, corners : (n,), as of `camgeo.geometry.outline.roller.Parallel`.
    """

    arcs: Branches
    cubics: Cubics
    starts: FloatArray
    ends: FloatArray
    elements: IntArray
    corners: FloatArray

    def jet(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: Literal[0, 2, 3]
    ) -> FloatArray:
        """See `Touched`."""
        out = np.empty((order + 1, len(phi)))
        first = len(self.arcs.elements)
        plain = index < first
        out[:, plain] = self.arcs.jet(path, phi[plain], index[plain], order)
        curved = ~plain
        if np.any(curved):
            out[:, curved] = self._on_cubics(path, phi[curved], index[curved] - first, order)
        return out

    def _on_cubics(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: int
    ) -> FloatArray:
        t = self.touching(path, phi, index)
        point, normal, _, kappa, slope = self.cubics.traced(index, t)
        _, q = path.cam_angle_of(point)
        found = lift_jet(path, phi, q, Bows(point, normal, kappa), slope)
        return found[: order + 1]

    def touching(self, path: FollowerPath, phi: FloatArray, index: IntArray) -> FloatArray:
        """(n,) parameters of the cubics `index` (n,) that the roller touches at `phi` (n,) [rad].

        Raises
        ------
        GeometryError
            If Newton's method finds none.
        """
        spans = self.ends[index] - self.starts[index]
        t = np.clip(_signed(phi - self.starts[index]) / spans, 0.0, 1.0)
        for _ in range(STEPS):
            point, normal, pace, _, _ = self.cubics.traced(index, t)
            angles, q = path.cam_angle_of(point)
            # Along the parallel dZ = (Z_phi) dphi + (Z_q) dq; the part across the path is dphi's.
            across = np.conj(path.along(angles, q)[0])
            turning = (across * (-1j * path.rotation) * point).imag
            rate = (across * 1j * normal).imag * pace
            step = _signed(phi - angles) * turning / rate
            moved = np.clip(t + step, -BEYOND, 1.0 + BEYOND)
            last = np.max(np.abs((moved - t) * spans), initial=0.0)
            t = moved
            if last <= SETTLED:
                return t
        raise GeometryError("the roller does not touch the spline where it should")


def replay_spline(
    pitch: PitchCurve,
    contour: SplineContour,
    flank: str = Flank.INNER,
    *,
    step: float = STEP,
    corner: float = CORNER,
) -> Replay:
    """The roller of `pitch` on a closed contour of cubics, arcs and lines, counter-clockwise.

    Otherwise as `camgeo.geometry.outline.replay.replay_contour`.

    Raises
    ------
    GeometryError
        If the contour turns in at a corner or has a curvature that the roller does not fit into, or
        does not run once round the cam axis within the follower's reach.
    """
    press = Flank(flank).sign
    path = path_of(pitch.follower, pitch.rotation)
    chain, lows, highs = _chain(contour, -press * pitch.follower.roller_radius, path)
    order = np.argsort(lows, kind="stable")
    spans = np.remainder(highs - lows, TURN)
    order = order[spans[order] > GAP]
    apart = np.abs(_signed(np.roll(lows[order], -1) - highs[order]))
    if not np.all(apart <= GAP) or not abs(float(np.sum(spans[order])) - TURN) <= GAP * len(order):
        raise GeometryError("the spline does not lead the roller once round the cam axis")
    lift = ActualLift(path, pitch.motion, chain, lows[order], order)
    return compared(pitch, lift, press, step, corner)


def _chain(
    contour: SplineContour, distance: float, path: FollowerPath
) -> tuple[Chain, FloatArray, FloatArray]:
    """The chain, and where each of its branches begins and ends over the cam angle [rad]."""
    pieces: list[Arc | ComplexArray] = []
    for strand in contour.strands:
        pieces += list(strand.beziers) if isinstance(strand, CubicSpline) else [strand]
    cubic = np.array([not isinstance(each, Arc) for each in pieces])
    beziers = np.array([each for each in pieces if not isinstance(each, Arc)]).reshape(-1, 4)
    arcs = [each for each in pieces if isinstance(each, Arc)]
    numbers = np.arange(len(pieces))
    plain = _arcs(arcs, numbers[~cubic], distance)
    cubics = Cubics(beziers, distance)
    ends = [_headings(each) for each in pieces]
    corners = _corners(pieces, ends, distance)
    straight = branches(joined([plain, corners]), path)
    if np.any(straight.facing < 0.0):
        raise _folded()
    starts, finishes = _ranges(cubics, path)
    forward = path.rotation < 0
    lows, highs = (starts, finishes) if forward else (finishes, starts)
    whole = Chain(
        straight,
        cubics,
        starts,
        finishes,
        np.concatenate((straight.elements, numbers[cubic])),
        np.concatenate((straight.corners, np.full(len(beziers), TURN))),
    )
    return (
        whole,
        np.concatenate((straight.lows, _in_turn(lows))),
        np.concatenate((straight.highs, _in_turn(highs))),
    )


def _ranges(cubics: Cubics, path: FollowerPath) -> tuple[FloatArray, FloatArray]:
    """Cam angles (n,) [rad] at both ends of each parallel; raises if it is folded."""
    count = len(cubics.pieces)
    index = np.repeat(np.arange(count), LOOKS)
    t = np.tile(np.linspace(0.0, 1.0, LOOKS), count)
    point, normal, pace, _, _ = cubics.traced(index, t)
    angles, q = path.cam_angle_of(point)
    along, _ = path.along(angles, q)
    if not np.all((pace > 0.0) & (dot(normal, along) > 0.0)):
        raise _folded()
    rows = angles.reshape(count, LOOKS)
    return rows[:, 0], rows[:, 0] + np.sum(_signed(np.diff(rows, axis=1)), axis=1)


def _arcs(arcs: list[Arc], numbers: IntArray, distance: float) -> Parallel:
    """The parallels of lines and arcs."""
    starts, ends = (
        np.array([getattr(each, of) for each in arcs], complex) for of in ("start", "end")
    )
    sweeps = np.array([each.sweep for each in arcs])
    radii = np.array([each.radius for each in arcs])
    headings = [_headings(each) for each in arcs]
    first, last = (-1j * np.array([each[k] for each in headings], complex) for k in (0, 1))
    curved = sweeps != 0.0
    kappa = np.where(curved, np.sign(sweeps) / np.where(curved, radii, 1.0), 0.0)
    share = 1.0 + kappa * distance
    if np.any(share <= 0.0):
        raise _folded()
    lengths = np.where(curved, 0.0, np.abs(ends - starts))
    return cut(
        starts + distance * first, ends + distance * last, first, kappa / share, sweeps, lengths,
        numbers,
    )  # fmt: skip


def _corners(
    pieces: list[Arc | ComplexArray], headings: list[tuple[complex, complex]], distance: float
) -> Parallel:
    """The arcs about the vertices at which the contour turns."""
    first = np.array([each[0] for each in headings])
    last = np.roll([each[1] for each in headings], 1)
    turns = np.angle(first * last.conj())
    found = np.flatnonzero(np.abs(turns) > CORNER)
    if np.any(turns[found] * distance <= 0.0):
        raise GeometryError("the spline has a corner that turns towards the roller")
    starts = [each.start if isinstance(each, Arc) else each[0] for each in pieces]
    vertices, before, after = np.array(starts)[found], -1j * last[found], -1j * first[found]
    return cut(
        vertices + distance * before,
        vertices + distance * after,
        before,
        np.full(len(found), 1.0 / distance if distance else 0.0),
        turns[found],
        np.zeros(len(found)),
        -1 - found,
    )


def _headings(piece: Arc | ComplexArray) -> tuple[complex, complex]:
    """Unit directions at both ends of a piece."""
    if isinstance(piece, Arc):
        ways = piece.heading(piece.start), piece.heading(piece.end)
    else:
        ways = complex(piece[1] - piece[0]), complex(piece[3] - piece[2])
    return ways[0] / abs(ways[0]), ways[1] / abs(ways[1])


def _folded() -> GeometryError:
    return GeometryError(
        "the spline is curved more tightly than the roller, or runs along the follower's path"
    )


def _signed(angles: FloatArray) -> FloatArray:
    """(n,) the same angles [rad] in [-pi, pi)."""
    return np.asarray(np.remainder(angles + 0.5 * TURN, TURN) - 0.5 * TURN)


def _in_turn(angles: FloatArray) -> FloatArray:
    """(n,) the same angles [rad] in [0, 2 pi)."""
    found = np.remainder(angles, TURN)
    return np.where(found < TURN, found, 0.0)
