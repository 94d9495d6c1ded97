"""Replay: the follower pressed against a real outline, or any contour, over a turn.

The actual motion of the follower, compared with the demanded one: lift, velocity and acceleration
over the cam angle, lost stroke, shocks. The lift is that of the follower itself; behind a linkage
that is the rocker's angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgeo.curve.extremes import extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.follower_path import path_of
from camgeo.motion.motion import Motion
from camgeo.motion.piece import SNAP
from camgeo.numeric.arrays import SIDES, FloatArray, IntArray, Side, ascending
from camgeo.numeric.extremes import Extreme
from camgeo.outline.face_hull import hull_of
from camgeo.outline.face_lift import face_between, face_on
from camgeo.outline.path import Flank, Path, Stretch
from camgeo.outline.replay_lift import AS_DEMANDED, ActualLift, PlayedLift, pressed
from camgeo.outline.replay_result import DiscLift, Jumps, Replay, held_at
from camgeo.outline.roller_path import LinesAndArcs, branches, circles, parallel
from camgeo.units import TURN

STEP = math.radians(0.1)
"""Step of the cam angle between the samples, for pictures; the ends of all pieces are sampled as
well."""

CORNER = 1e-7
"""Corners up to this angle [rad] are ignored: the directions of two pieces at their common end are
known to the rounding of its coordinates over their length, 1e-14 mm over 1e-7 mm at worst."""

DROP = 1e-9
"""Jumps of the lift up to this fraction of the base radius (of 1 rad for a rocker) are rounding."""


def replay_contour(
    pitch: PitchCurve,
    contour: LinesAndArcs,
    flank: str = Flank.INNER,
    *,
    step: float = STEP,
    corner: float = CORNER,
) -> Replay:
    """The follower of `pitch` on any closed contour of lines and arcs.

    A flat face touches the convex hull of the contour.

    Parameters
    ----------
    contour : in cam coordinates, counter-clockwise round the cam axis: the boundary of the disc for
        the inner flank, that of the hole for the outer one, into which the roller is pressed.
    flank : "inner" or "outer".
    step : of the samples [rad].
    corner : corners up to this angle [rad] are ignored, both as shocks and as ripple.

    Raises
    ------
    GeometryError
        If the contour does not run counter-clockwise, or not round the cam axis within the
        follower's reach; for a flat face on an outer flank.
    """
    press = Flank(flank).sign
    if not pitch.follower.has_pitch_curve:
        _require_inner(press)
        return compared(
            pitch, face_on(hull_of(contour), pitch).without_corners(corner), press, step, corner
        )
    path = path_of(pitch.follower, pitch.rotation)
    found = branches(parallel(contour, -press * pitch.follower.roller_radius), path)
    whole = (np.zeros(1), np.full(1, TURN))
    borders, numbers = pressed(found, path, press, whole)
    lift = ActualLift(path, pitch.motion, found, borders, numbers).without_corners(corner)
    return compared(pitch, lift, press, step, corner)


def replay_outline(
    pitch: PitchCurve,
    outline: Path,
    *,
    step: float = STEP,
    corner: float = CORNER,
    clearance: float = 0.0,
) -> Replay:
    """The follower of `pitch` on a real outline, exactly.

    On a stretch of the working curve the roller is where it should be. Where a stretch is missing,
    it runs over the outline's corners: it cannot touch another stretch there, for the roller that
    touches a stretch has its own cam angle. A flat face rocks over the corner itself.

    With a `clearance` [mm] the outline is a flank of a groove that is wider than the roller by it;
    pressed against the flank the roller is off by about half of that everywhere.

    Raises
    ------
    GeometryError
        If the outline has no stretches, or the roller finds no corner where one is missing; with
        clearance if the outline is not the whole flank, or the clearance is too large.
    """
    stretches = outline.stretches
    if not stretches:
        raise GeometryError("an outline without any stretch of the working curve holds no follower")
    distance = stretches[0].curve.distance
    press = -1 if math.copysign(1.0, distance) < 0.0 else 1  # -0 on the inside of a knife edge
    if not pitch.follower.has_pitch_curve:
        _require_inner(press)
        corners = np.array([each.centre for each in outline.pivots], dtype=np.complex128)
        starts, ends = _gaps(stretches)
        if len(corners) != len(starts):
            raise GeometryError("a stretch is missing where the outline has no corner for the face")
        face = face_between(pitch, corners, starts, ends)
        return compared(pitch, face, press, step, corner)
    radius = abs(distance)
    # A pivot at no distance from the roller centre is the roller's turn about its own centre.
    pivots = [each for each in outline.offset(-distance).pivots if each.distance != 0.0]
    if any(abs(abs(each.distance) - radius) > DROP * radius for each in pivots):
        raise GeometryError("the outline has an arc where the roller must find a corner")
    path, played = path_of(pitch.follower, pitch.rotation), None
    if clearance > 0.0:
        if not outline.is_whole:
            raise GeometryError(
                "the flank is trimmed or has a corner, and the groove has side clearance: replay a"
                " drawing of it"
            )
        played = PlayedLift(path, WorkingCurve(pitch, 0.5 * press * clearance))
    centres = np.array([each.centre for each in pivots], dtype=np.complex128)
    found = branches(circles(centres, radius or 1.0), path)  # a knife edge has no such pivots
    starts, ends = _gaps(stretches)
    borders, numbers = np.zeros(1), np.full(1, AS_DEMANDED)
    if len(starts):
        borders, numbers = pressed(found, path, press, (starts, ends))
    lift = ActualLift(path, pitch.motion, found, borders, numbers, played)
    return compared(pitch, lift, press, step, corner)


def _require_inner(press: int) -> None:
    if press > 0:
        raise GeometryError("a flat face runs on the inner flank, outside of the disc", key="flank")


def _gaps(stretches: tuple[Stretch, ...]) -> tuple[FloatArray, FloatArray]:
    """Starts and ends (k,), (k,) [rad] of the ranges between neighbouring stretches."""
    starts = np.array([each.end % TURN for each in stretches])
    ends = np.roll([each.start for each in stretches], -1)
    widths = np.remainder(ends - starts, TURN)
    # Where a stretch follows at once, across a turn of the roller, rounding may add a full turn.
    widths[np.minimum(widths, TURN - widths) <= SNAP] = 0.0
    gaps = np.flatnonzero(widths > 0.0)
    return starts[gaps], starts[gaps] + widths[gaps]


def compared(
    pitch: PitchCurve,
    lift: DiscLift,
    press: int,
    step: float = STEP,
    corner: float = CORNER,
) -> Replay:
    """The replay of `lift`."""
    motion = pitch.motion
    peaks = [_peak(motion, order) for order in (1, 2)]
    count = math.ceil(TURN / step)
    grid = np.arange(count, dtype=np.float64) * (TURN / count)
    grid = ascending(np.concatenate((grid, [peak.place for peak in peaks])))
    special = ascending(np.concatenate((lift.borders, lift.breaks)))
    lifts = [lift.at(special, side) for side in SIDES]
    dropped = np.abs(lifts[1] - lifts[0]) > DROP * pitch.follower.lift_scale
    drops = Jumps(special[dropped], lifts[0][dropped], lifts[1][dropped])
    special = special[~dropped]
    grid = grid[~np.isin(grid, np.concatenate((special, drops.phi)))]
    left, right = (_Samples.of(lift, special, side) for side in SIDES)
    shocks = _shocks(lift, left, right, corner)
    # The left side of cam angle 0 is the end of the turn.
    left = replace(left, phi=np.where(left.phi == 0.0, TURN, left.phi))
    parts = (left, _Samples.of(lift, grid, "right"), right)
    phi = np.concatenate([part.phi for part in parts])
    order = np.argsort(phi, kind="stable")
    numbers = np.concatenate([part.numbers for part in parts])[order]
    element, smooth = held_at(lift, numbers, corner)
    return Replay(
        lift=lift,
        press=press,
        corner=corner,
        phi=phi[order],
        demanded=np.concatenate([part.demanded for part in parts], axis=1)[:, order],
        actual=np.concatenate([part.actual for part in parts], axis=1)[:, order],
        element=element,
        smooth=smooth,
        shocks=shocks,
        drops=drops,
        demanded_velocity=peaks[0].value,
        demanded_acceleration=peaks[1].value,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Samples:
    """Cam angles (n,) [rad], the branches (n,) there, demanded and actual jets (3, n)."""

    phi: FloatArray
    numbers: IntArray
    demanded: FloatArray
    actual: FloatArray

    @classmethod
    def of(cls, lift: DiscLift, phi: FloatArray, side: Side) -> _Samples:
        return cls(
            phi,
            lift.number(phi, side),
            lift.motion.jet(phi, side, 2)[:3],
            lift.jet(phi, side),
        )


def _shocks(lift: DiscLift, left: _Samples, right: _Samples, corner: float) -> Jumps:
    """Where the direction in which the roller centre runs turns by more than `corner`."""
    before, after = (lift.heading(side.phi, side.actual) for side in (left, right))
    turned = np.abs(np.angle(after * before.conj()))
    found = turned > corner
    return Jumps(right.phi[found], left.actual[1][found], right.actual[1][found])


def _peak(motion: Motion, order: int) -> Extreme:
    """Largest magnitude of a derivative of the demanded lift, exactly."""
    found = extremes(
        motion,
        lambda phi, side: motion.jet(phi, side)[order],
        lambda phi, side: motion.jet(phi, side)[order + 1],
    )
    sides = (found.smallest(), found.largest())
    value, place = max(sides, key=lambda side: abs(side[0]))
    return Extreme(abs(value), place)
