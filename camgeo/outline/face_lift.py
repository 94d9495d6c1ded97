"""The part of the disc that a flat face touches at each cam angle, and the resulting lift.

The face is pressed inward until it touches: what holds it is the convex hull of the disc, see
`camgeo.outline.face_hull`. As long as the contact is on the rocker's own side of the pivot's foot,
the cam angle runs steadily with the normal, so that each place of the hull holds the face over one
range of cam angle, known exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.face import flat_follower
from camgeo.mechanism.face_path import FacePath, face_path_of
from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import SIDES, ComplexArray, FloatArray, IntArray, Side
from camgeo.outline.convex import contact_extremes, touch
from camgeo.outline.face_hull import Circles, Hull
from camgeo.outline.layers import piece_at
from camgeo.outline.path import Path
from camgeo.outline.replay_lift import AS_DEMANDED
from camgeo.units import TURN

SIDE = 1e-6
"""Difference of a lift from itself, by rounding, close to where the contact loses its lever."""

STEADY = 1e-9
"""Cam angle [rad] by which neighbouring borders may come in the wrong order, by rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceLift:
    """The actual lift of a flat face that is pressed against a disc, over the cam angle.

    Attributes
    ----------
    path : of the face.
    pitch : the demanded contact curve, of the demanded motion.
    circles : what may be touched.
    borders : (k,) cam angles [rad] in [0, 2 pi), ascending, at which what is touched changes.
    numbers : (k,) the circle from each border to the next, or AS_DEMANDED.
    widths : (n,) range of normals [rad] over which each of `circles` is touched.
    """

    path: FacePath
    pitch: PitchCurve
    circles: Circles
    borders: FloatArray
    numbers: IntArray
    widths: FloatArray

    @property
    def motion(self) -> Motion:
        """The demanded lift."""
        return self.pitch.motion

    @property
    def outward(self) -> int:
        """See `camgeo.outline.replay_result.DiscLift`."""
        return self.path.outward

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] where a derivative of the demanded lift may jump."""
        return self.motion.breaks

    @property
    def knots(self) -> FloatArray:
        """See `camgeo.outline.replay_result.DiscLift`."""
        return self.motion.borders

    @property
    def as_demanded(self) -> bool:
        """See `camgeo.outline.replay_result.DiscLift`."""
        return True

    def number(self, phi: FloatArray, side: Side = "right") -> IntArray:
        """(n,) the circle at `phi` (n,) [rad]."""
        return piece_at(self.borders, self.numbers, phi, side)

    def held_by(self, numbers: IntArray) -> tuple[IntArray, FloatArray]:
        """See `camgeo.outline.replay_result.DiscLift`."""
        bent = self.circles.radii[numbers] > 0.0
        return self.circles.elements[numbers], np.where(bent, TURN, self.widths[numbers])

    def without_corners(self, corner: float) -> FaceLift:
        """The same lift where the face does not rock about corners of up to `corner` [rad], see
        `camgeo.outline.replay_lift.ActualLift.without_corners`.

        Nothing but corners may lie between two corners; of such a row only what turns by no more
        than `corner` together is left out.
        """
        _, turns = self.held_by(self.numbers)
        small = turns <= corner
        turned = np.cumsum(np.where(small, turns, 0.0))
        in_row = turned - np.maximum.accumulate(np.where(small, 0.0, turned))
        kept = ~small | (in_row > corner)
        return replace(self, borders=self.borders[kept], numbers=self.numbers[kept])

    def at(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) lift [mm or rad] at `phi` (n,) [rad]."""
        return np.asarray(self._rows(phi, side, 0)[0])

    def jet(self, phi: FloatArray, side: Side = "right", order: Literal[2, 3] = 2) -> FloatArray:
        """(order + 1, n) lift with derivatives [mm or rad per rad^k] at `phi` (n,) [rad]."""
        return self._rows(phi, side, order)

    def _rows(self, phi: FloatArray, side: Side, order: Literal[0, 2, 3]) -> FloatArray:
        number = self.number(phi, side)
        held = number != AS_DEMANDED
        out = np.empty((order + 1, len(phi)))
        if not np.all(held):
            made = self.motion.jet(phi[~held], side, max(order, 1))
            out[:, ~held] = made[: order + 1]
        if np.any(held):
            which = number[held]
            circles = self.circles
            jet = self.path.jet(phi[held], circles.centres[which], circles.radii[which])
            out[:, held] = jet[: order + 1]
        return out

    def contacts(self) -> tuple[FloatArray, FloatArray]:
        """Places of the contact along the face (n,) [mm], all extremes among them, and their cam
        angles (n,) [rad] in [0, 2 pi).
        """
        widths = np.roll(self.borders, -1) - self.borders
        widths[-1:] += TURN
        held = np.flatnonzero(self.numbers != AS_DEMANDED)
        starts, which = self.borders[held], self.numbers[held]
        ends = starts + widths[held]
        centres, radii = self.circles.centres[which], self.circles.radii[which]
        phi = np.stack((starts, ends, *_turning_within(self.path, starts, ends, centres)))
        places = self.path.contact(phi, centres, radii)
        found = [(places.ravel(), phi.ravel() % TURN)]
        if len(held) < len(self.numbers):
            extremes = contact_extremes(self.pitch)
            free = self.number(extremes.phi) == AS_DEMANDED
            found.append((extremes.values[free], extremes.phi[free] % TURN))
        return np.concatenate([each[0] for each in found]), np.concatenate(
            [each[1] for each in found]
        )

    def heading(self, phi: FloatArray, jet: FloatArray) -> ComplexArray:
        """See `camgeo.outline.replay_result.DiscLift`: of the contact, if it did not wander."""
        at = flat_follower(self.pitch.follower).touch(_full(jet), self.path.rotation)
        way: ComplexArray = at.distance + 1j * at.contact[0]
        del phi
        return way

    def shift_of(self, joint: float, error: FloatArray) -> FloatArray:
        """See `camgeo.outline.replay_result.DiscLift`.

        The contact is off along the face by its error, in which that of the velocity counts, and
        runs along the outline with the pace p.
        """
        shifts = []
        for side in SIDES:
            at = touch(self.pitch, np.array([joint]), side)
            pace = abs(float(at.pace[0, 0]))
            shifts.append(float(self.path.wander(at)[0]) / pace if pace > 0.0 else math.inf)
        return np.asarray(max(shifts) * np.abs(error[1]))


def _full(jet: FloatArray) -> FloatArray:
    """A jet (3, n) with zeros for the third derivative."""
    return np.vstack((jet, np.zeros_like(jet[:1])))


def face_on(hull: Hull, pitch: PitchCurve) -> FaceLift:
    """The flat face of `pitch` on a contour with the convex `hull`.

    Raises
    ------
    GeometryError
        If the contour does not go round the cam axis, or a rocker's face cannot lie on it all
        round, with its contact on the rocker's own side of the pivot's foot.
    """
    path = face_path_of(pitch.follower, pitch.rotation)
    _require_axis(hull)
    lift = path.lift_of(hull.ends())
    angles = path.angle_of(hull.normals, lift)
    centres, radii = hull.circles.centres[hull.touched], hull.circles.radii[hull.touched]
    _require_side(path, angles, lift, centres, radii)
    ascent = -path.rotation * angles
    low = np.maximum.accumulate(ascent)
    if np.any(low - ascent > STEADY):
        raise GeometryError(NO_LEVER)
    low = np.minimum(low, low[0] + TURN)
    high = np.append(low[1:], low[0] + TURN)
    starts, ends = (low, high) if path.rotation < 0 else (-high, -low)
    _require_lever(path, starts, ends, centres, radii)
    # By ascending cam angle: of several that begin at one, to rounding, the last one counts.
    order = np.arange(len(starts))[:: -path.rotation]
    turned = starts[order] % TURN
    order = np.roll(order, -_wrap(turned))
    borders = np.maximum.accumulate(np.roll(turned, -_wrap(turned)))
    numbers = hull.touched[order]
    widths = np.zeros(len(hull.circles.radii))
    np.add.at(widths, hull.touched, hull.widths)
    return FaceLift(path, pitch, hull.circles, borders, numbers, widths)


def _wrap(turned: FloatArray) -> int:
    """Index of the first of the cam angles `turned` (k,) [rad], which ascend over a turn from
    anywhere in it.
    """
    return int(np.argmin(np.diff(turned, prepend=turned[-1:])))


NO_LEVER = (
    "the contact reaches the pivot's foot on the face: the contour cannot move the rocker there"
)


def _require_axis(hull: Hull) -> None:
    """Raise GeometryError unless all distances are positive: each is a sine, lowest at an end of
    its range or where its circle lies opposite.
    """
    centres, radii = hull.circles.centres[hull.touched], hull.circles.radii[hull.touched]
    opposite = (np.angle(centres) + math.pi - hull.normals) % TURN < hull.widths
    lowest = np.where(opposite, radii - np.abs(centres), np.inf)
    if not np.all(np.minimum(hull.ends(), lowest) > 0.0):
        raise GeometryError("the contour must run once round the cam axis")


def _require_side(
    path: FacePath, phi: FloatArray, lift: FloatArray, centres: ComplexArray, radii: FloatArray
) -> None:
    """Raise GeometryError unless the face has the `lift` (k,) at `phi` (k,) on these circles by a
    contact on its own side.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.abs(path.jet(phi, centres, radii)[0] - lift)
    if not np.all(apart <= SIDE * np.maximum(1.0, np.abs(lift))):
        raise GeometryError(NO_LEVER)


def _require_lever(
    path: FacePath, starts: FloatArray, ends: FloatArray, centres: ComplexArray, radii: FloatArray
) -> None:
    """Raise GeometryError where a contact comes to the pivot's foot between `starts` and `ends`."""
    for phi in (starts, ends, *_turning_within(path, starts, ends, centres)):
        if not np.all(np.isfinite(path.contact(phi, centres, radii))):
            raise GeometryError(NO_LEVER)


def _turning_within(
    path: FacePath, starts: FloatArray, ends: FloatArray, centres: ComplexArray
) -> FloatArray:
    """(2, k) cam angles [rad] at which the place of the contact is extreme in each range; its start
    where there are none in it.
    """
    offset = (path.turning(centres) - starts) % TURN
    return np.where(offset < ends - starts, starts + offset, starts)


def face_between(
    pitch: PitchCurve, corners: ComplexArray, starts: FloatArray, ends: FloatArray
) -> FaceLift:
    """The flat face of `pitch` on a trimmed outline: on each of the `corners` (k,) [mm] from
    `starts` to `ends` (k,) [rad], between them as demanded.

    Raises
    ------
    GeometryError
        If the contact with a corner comes to the pivot's foot.
    """
    path = face_path_of(pitch.follower, pitch.rotation)
    at_ends = np.concatenate((starts, ends))
    twice, none = np.concatenate((corners, corners)), np.zeros(2 * len(corners))
    _require_side(path, at_ends, pitch.motion.jet(at_ends, "right", 1)[0], twice, none)
    _require_lever(path, starts, ends, corners, none[: len(corners)])
    count = np.arange(len(corners))
    circles = Circles(corners, np.zeros(len(corners)), -1 - count)
    borders = np.concatenate((starts, ends)) % TURN
    numbers = np.concatenate((count, np.full(len(corners), AS_DEMANDED)))
    order = np.lexsort((numbers == AS_DEMANDED, borders))
    borders, numbers = borders[order], numbers[order]
    if not len(corners):
        borders, numbers = np.zeros(1), np.full(1, AS_DEMANDED)
    return FaceLift(path, pitch, circles, borders, numbers, np.full(len(corners), TURN))


def contact_places(curve: PitchCurve, outline: Path) -> tuple[FloatArray, FloatArray]:
    """See `FaceLift.contacts`, on a real outline.

    Raises GeometryError if the contact with a corner comes to the pivot's foot.
    """
    pivots = outline.pivots
    starts = np.array([each.before for each in pivots])
    widths = np.array([each.after for each in pivots]) - starts
    corners = np.array([each.centre for each in pivots], dtype=np.complex128)
    return face_between(curve, corners, starts, starts + widths % TURN).contacts()
