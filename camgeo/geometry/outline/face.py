"""Where a flat face touches a contour, and the cam, at each cam angle.

The face with the normal at theta lies at the distance

    h(theta) = max over the contour of Re(exp(-i theta) P),

its support function. Of a line only the ends can be touched alone, of an arc that turns in only its
ends, of one that turns out, a circle of radius R about C, all places between the normals at its
ends, at the distance Re(exp(-i theta) C) + R; a point is a circle of radius 0. So h is the upper
envelope of sines, exactly: the vertices that count are those of their convex hull, each between the
normals of the hull's sides, and within a range of theta where the same arcs are present two
distances are equal at the roots of a sine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import TYPE_CHECKING, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import (
    MOST_PAIRS,
    NONE,
    AngleCells,
    Pairs,
    changes,
    cover_cells,
    outermost,
    pairs_in_cells,
    too_rough_error,
    visible_pieces,
)
from camgeo.geometry.outline.path import Path
from camgeo.geometry.outline.roller import AS_DEMANDED, DiscLift
from camgeo.geometry.pieces import (
    contact_extremes,
    touch,
)
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, Touch, TranslatingFlat, flat_follower
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.numeric.arrays import (
    SIDES,
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    ascending,
    phase,
)
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.geometry.contour.contour import Contour

WIDEST = math.pi / 4.0
"""Widest range of normals [rad] of the cells in which distances are compared."""

LAYERS = "its vertices and arcs overlap"


@dataclass(frozen=True, slots=True, eq=False)
class TouchableCircles:
    """n circles and points that a face touches.

    Attributes
    ----------
    centres : (n,) complex [mm].
    radii : (n,) [mm], 0 for points.
    elements : (n,) number of the contour's piece, -1 - k of its vertex k.
    """

    centres: ComplexArray
    radii: FloatArray
    elements: IntArray

    def distance(self, which: IntArray, theta: FloatArray) -> FloatArray:
        """(k,) h [mm] of the circles `which` (k,) for normals at theta (k,) [rad]."""
        turned = self.centres[which] * np.exp(-1j * theta)
        return np.asarray(turned.real + self.radii[which])


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """The convex hull of a contour by its normals.

    Attributes
    ----------
    circles : what may be touched.
    normals : (k,) theta [rad], ascending from one in [0, 2 pi) over less than a turn, at which what
        is touched changes.
    touched : (k,) the circle from each of them to the next.
    """

    circles: TouchableCircles
    normals: FloatArray
    touched: IntArray

    @property
    def widths(self) -> FloatArray:
        """(k,) range of normals [rad] over which each is touched."""
        ends = np.append(self.normals[1:], self.normals[0] + TURN)
        return np.asarray(ends - self.normals)

    def ends(self) -> FloatArray:
        """(k,) h [mm] at `normals`."""
        return self.circles.distance(self.touched, self.normals)


def contour_hull(contour: Contour) -> Hull:
    """The convex hull of `contour`.

    Raises
    ------
    GeometryError
        If the contour does not run counter-clockwise round an area, or is too rough.
    """
    if not contour.area > 0.0:
        raise GeometryError("the contour must enclose an area and run counter-clockwise")
    corner = _convex_hull(contour.vertices)
    points = contour.vertices[corner]
    sides = np.roll(points, -1) - points
    # The face rests on a vertex between the normals of the sides that meet there.
    leaving = np.angle(-1j * sides) % TURN
    arcs = np.flatnonzero(contour.sweeps > 0.0)
    first = contour.vertices[arcs] - contour.centres[arcs]
    starts = np.angle(first) % TURN
    circles = TouchableCircles(
        np.concatenate((points, contour.centres[arcs])),
        np.concatenate((np.zeros(len(points)), np.abs(first))),
        np.concatenate((-1 - corner, arcs)),
    )
    lows = np.concatenate((np.roll(leaving, 1), starts))
    spans = np.concatenate(((leaving - np.roll(leaving, 1)) % TURN, contour.sweeps[arcs]))
    return _envelope(circles, lows, np.minimum(spans, TURN))


def _convex_hull(points: ComplexArray) -> IntArray:
    """Indices of the vertices of the convex hull, counter-clockwise, without those on its sides."""
    # Andrew's monotone chain: the lower hull from left to right, then the upper one back.
    order = np.lexsort((points.imag, points.real))
    chains = []
    for run in (order.tolist(), order[::-1].tolist()):
        chain: list[int] = []
        for index in run:
            while len(chain) > 1:
                a, b, c = points[chain[-2]], points[chain[-1]], points[index]
                if ((b - a).conjugate() * (c - b)).imag > 0.0:
                    break
                chain.pop()
            chain.append(index)
        chains.append(chain[:-1])
    return np.array(chains[0] + chains[1] or [0], dtype=np.intp)  # a circle has one vertex


def _envelope(circles: TouchableCircles, lows: FloatArray, spans: FloatArray) -> Hull:
    """The upper envelope of the distances of `circles` (n,), each over its range of normals."""
    whole = np.arange(0.0, TURN, WIDEST)
    nodes = ascending(np.concatenate((whole, lows % TURN, (lows + spans) % TURN)))
    cells = AngleCells.from_nodes(nodes)
    first = np.searchsorted(nodes, lows % TURN)
    number = np.remainder(np.searchsorted(nodes, (lows + spans) % TURN) - first, len(cells))
    # A range that ends in the node where it begins is the whole turn, not nothing.
    number[(number == 0) & (spans > math.pi)] = len(cells)
    pairs = cover_cells(cells, first, number, LAYERS)
    pairs = _without_hidden(circles, cells, *pairs)
    grid, _, held = outermost(cells, pairs, _crossings(circles, cells, *pairs), circles.distance)
    return Hull(circles, *changes(grid[held != NONE], held[held != NONE]))


def _without_hidden(
    circles: TouchableCircles, cells: AngleCells, cell: IntArray, which: IntArray
) -> Pairs:
    """The pairs of a cell and a circle without those that lie behind another one throughout."""
    low, high = cells.low[cell], cells.high[cell]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    turned = circles.centres[which] * np.exp(-1j * middle)
    size = np.abs(turned)
    here = turned.real + circles.radii[which]
    # The distance is a sine of the normal: bounds from its slope and bend in the middle.
    change = half * np.abs(turned.imag) + 0.5 * half * half * size
    visible = visible_pieces(cell, here - change, here + change)
    return cell[visible], which[visible]


def _crossings(
    circles: TouchableCircles, cells: AngleCells, cell: IntArray, which: IntArray
) -> FloatArray:
    """(k,) theta in [0, 2 pi) inside cells at which two of their circles are equally far."""
    crossings = [np.empty(0)]
    examined = 0
    for index, with_index in pairs_in_cells(cell):
        examined += len(index)
        if examined > MOST_PAIRS:
            raise too_rough_error(LAYERS, len(cell) / len(cells))
        one, other = which[index], which[with_index]
        low, high = cells.low[cell[index]], cells.high[cell[index]]
        way = circles.centres[other] - circles.centres[one]
        size, rise = np.abs(way), circles.radii[one] - circles.radii[other]
        with np.errstate(divide="ignore", invalid="ignore"):
            # Equal distances: Re(exp(-i theta) way) = rise.
            away = np.arccos(rise / size)
        for theta in (np.angle(way) + away, np.angle(way) - away):
            offset = (theta - low) % TURN
            crossed = (offset > 0.0) & (offset < high - low)
            crossings.append((low + offset)[crossed] % TURN)
    return np.concatenate(crossings)


# -- face lift ------------------------------------------------------------------------------------
# The part of the disc that a flat face touches at each cam angle, and the resulting lift.
#
# The face is pressed inward until it touches: what holds it is the convex hull of the disc, see
# the top of this module. As long as the contact is on the rocker's own side of the pivot's
# foot, the cam angle runs steadily with the normal, so that each place of the hull holds the face
# over one range of cam angle, known exactly.


SIDE = 1e-6
"""Relative rounding error of a lift close to where the contact loses its lever."""

STEADY = 1e-9
"""Cam angle [rad] by which neighbouring borders may come in the wrong order, by rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceLift(DiscLift):
    """The actual lift of a flat face; its numbers are those of circles.

    Attributes
    ----------
    circles : what may be touched.
    widths : (n,) range of normals [rad] over which each of `circles` is touched.
    """

    path: FacePath
    circles: TouchableCircles
    widths: FloatArray

    def holding_elements(self, numbers: IntArray) -> tuple[IntArray, FloatArray]:
        """See `DiscLift`."""
        bent = self.circles.radii[numbers] > 0.0
        return self.circles.elements[numbers], np.where(bent, TURN, self.widths[numbers])

    def retained_borders(self, turns: FloatArray, corner: float) -> BoolArray:
        """See `DiscLift`.

        Nothing but corners may lie between two corners; of such a row only what turns by no more
        than `corner` together is left out.
        """
        small = turns <= corner
        # Sums of the turns of small corners since the last border that is none.
        turned = np.cumsum(np.where(small, turns, 0.0))
        in_row = turned - np.maximum.accumulate(np.where(small, 0.0, turned))
        return ~small | (in_row > corner)

    def held_jet(self, phi: FloatArray, numbers: IntArray, order: Literal[0, 2, 3]) -> FloatArray:
        """See `DiscLift`."""
        circles = self.circles
        return self.path.jet(phi, circles.centres[numbers], circles.radii[numbers])[: order + 1]

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
        phi = np.stack((starts, ends, *_contact_extremes(self.path, starts, ends, centres)))
        places = self.path.contact(phi, centres, radii)
        parts = [(places.ravel(), phi.ravel() % TURN)]
        if len(held) < len(self.numbers):
            extremes = contact_extremes(self.pitch)
            free = self.number(extremes.phi) == AS_DEMANDED
            parts.append((extremes.values[free], extremes.phi[free] % TURN))
        return np.concatenate([part[0] for part in parts]), np.concatenate(
            [part[1] for part in parts]
        )

    def heading(self, phi: FloatArray, jet: FloatArray) -> ComplexArray:
        """See `DiscLift`: of the contact, if it did not wander."""
        del phi  # the jet alone decides
        full = np.vstack((jet, np.zeros_like(jet[:1])))  # with a third derivative
        contact = flat_follower(self.pitch.follower).touch(full, self.path.rotation)
        return np.asarray(contact.distance + 1j * contact.contact[0])

    def joint_shift(self, joint: float, error: FloatArray) -> FloatArray:
        """See `DiscLift`.

        The contact is off along the face by its error, in which that of the velocity counts, and
        runs along the outline with the pace p.
        """
        shifts = []
        for side in SIDES:
            contact = touch(self.pitch, np.array([joint]), side)
            pace = abs(float(contact.pace[0, 0]))
            shifts.append(float(self.path.wander(contact)[0]) / pace if pace > 0.0 else math.inf)
        return np.asarray(max(shifts) * np.abs(error[1]))

    @classmethod
    def from_contour(cls, contour: Contour, pitch: PitchCurve) -> FaceLift:
        """The flat face of `pitch` on `contour`.

        Raises
        ------
        GeometryError
            As `contour_hull`; if the contour does not go round the cam axis, or a rocker's face
            cannot lie on it all round, with its contact on the rocker's own side of the pivot's
            foot.
        """
        path, hull = face_path_of(pitch.follower, pitch.rotation), contour_hull(contour)
        _require_axis(hull)
        lift = path.lift(hull.ends())
        angles = path.cam_angles(hull.normals, lift)
        centres, radii = hull.circles.centres[hull.touched], hull.circles.radii[hull.touched]
        _require_side(path, angles, lift, centres, radii)
        ascent = -path.rotation * angles
        # The cam angle ascends with the normal but for rounding; more than that is a lost lever.
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
        order = np.roll(order, -_first_index(turned))
        borders = np.maximum.accumulate(np.roll(turned, -_first_index(turned)))
        numbers = hull.touched[order]
        widths = np.zeros(len(hull.circles.radii))
        # A circle that is touched in several ranges has the sum of their widths.
        np.add.at(widths, hull.touched, hull.widths)
        return cls(path, pitch, borders, numbers, hull.circles, widths)

    @classmethod
    def from_corners(
        cls, pitch: PitchCurve, corners: ComplexArray, starts: FloatArray, ends: FloatArray
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
        circles = TouchableCircles(corners, np.zeros(len(corners)), -1 - count)
        borders = np.concatenate((starts, ends)) % TURN
        numbers = np.concatenate((count, np.full(len(corners), AS_DEMANDED)))
        order = np.lexsort((numbers == AS_DEMANDED, borders))
        borders, numbers = borders[order], numbers[order]
        if not len(corners):
            borders, numbers = np.zeros(1), np.full(1, AS_DEMANDED)
        return cls(path, pitch, borders, numbers, circles, np.full(len(corners), TURN))


def _first_index(turned: FloatArray) -> int:
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
        errors = np.abs(path.jet(phi, centres, radii)[0] - lift)
    if not np.all(errors <= SIDE * np.maximum(1.0, np.abs(lift))):
        raise GeometryError(NO_LEVER)


def _require_lever(
    path: FacePath, starts: FloatArray, ends: FloatArray, centres: ComplexArray, radii: FloatArray
) -> None:
    """Raise GeometryError where a contact comes to the pivot's foot between `starts` and `ends`."""
    for phi in (starts, ends, *_contact_extremes(path, starts, ends, centres)):
        if not np.all(np.isfinite(path.contact(phi, centres, radii))):
            raise GeometryError(NO_LEVER)


def _contact_extremes(
    path: FacePath, starts: FloatArray, ends: FloatArray, centres: ComplexArray
) -> FloatArray:
    """(2, k) cam angles [rad] at which the place of the contact is extreme in each range; its start
    where there are none in it.
    """
    offset = (path.turning(centres) - starts) % TURN
    return np.where(offset < ends - starts, starts + offset, starts)


def contact_places(curve: PitchCurve, outline: Path) -> tuple[FloatArray, FloatArray]:
    """See `FaceLift.contacts`, on a real outline.

    Raises GeometryError if the contact with a corner comes to the pivot's foot.
    """
    pivots = outline.pivots
    starts = np.array([pivot.phi_start for pivot in pivots])
    widths = np.array([pivot.phi_end for pivot in pivots]) - starts
    corners = np.array([pivot.centre for pivot in pivots], dtype=np.complex128)
    return FaceLift.from_corners(curve, corners, starts, starts + widths % TURN).contacts()


# -- face path ------------------------------------------------------------------------------------
# How a flat face lies on a circle or a point of the cam, at each cam angle.
#
# A face touches what is convex of an outline: its vertices and its arcs, circles of radius R >= 0
# about a centre C. In the frame, with the pivot or the guide at rest, the circle turns with the cam
# to C exp(i sigma phi), and the face is tangent to it on the inside. In closed form
#
# - on a guide h = Re(conj(n) C exp(i sigma phi)) + R, n the direction of the guide;
# - on a rocker, with V the circle's centre seen from the pivot, in the axis from the pivot to the
#   cam axis, and f the face's offset,
#
#       chi = m arg V - asin((f - R) / |V|), q = sqrt(|V|^2 - (f - R)^2):
#
#   the contact lies q from the pivot's foot on the face, on its own side.
#
# The lift is linear in h, or in chi. Seen from the cam, the face is the line at the distance h from
# the axis whose normal has the angle theta; its lift and theta determine the cam angle.


ROUNDING = 1e-12
"""How far rounding may take a sine beyond 1: the face is square to the line of centres there."""


@singledispatch
def face_path_of(follower: Follower, rotation: int) -> FacePath:
    """The path of a flat-faced `follower` on a cam that turns in the sense `rotation`.

    Raises GeometryError if none is registered for its class.
    """
    del rotation  # used by the registered ones
    raise GeometryError(
        f'a flat-faced follower is needed here, and this one is of the kind "{follower.kind}"',
        key="follower.kind",
        value=follower.kind,
    )


@dataclass(frozen=True, slots=True)
class GuidedFace:
    """The face of a translating follower: the places that it can have, in cam coordinates.

    Attributes
    ----------
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise.
    """

    follower: TranslatingFlat
    rotation: int

    @property
    def outward(self) -> int:
        """+1 if a positive lift moves the face outward, else -1."""
        return self.follower.direction

    def lift(self, distance: FloatArray) -> FloatArray:
        """(n,) lift [mm or rad] of the face at `distance` (n,) [mm] from the cam axis.

        Raises GeometryError where it cannot be there.
        """
        return np.asarray(self.outward * (distance - self.follower.base_radius))

    def cam_angles(self, theta: FloatArray, _: FloatArray) -> FloatArray:
        """(n,) cam angles [rad] at which the face of that lift (n,) has the normal at theta (n,)
        [rad] in the cam; as continuous as theta, not reduced to a turn.
        """
        return np.asarray(self.rotation * (self.follower.guide_angle - theta))

    def _turned(self, phi: FloatArray, centres: ComplexArray) -> ComplexArray:
        """(n,) complex [mm] the centres at `phi` (n,) [rad], in axes along and across the guide."""
        axis = self.follower.guide_angle
        return np.asarray(centres * np.exp(1j * (self.rotation * phi - axis)))

    def jet(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """(4, n) lift and three derivatives [mm or rad per rad^k] at `phi` (n,) [rad] with the face
        on the circles about `centres` (n,) of `radii` (n,) [mm], in cam coordinates.
        """
        turned = self._turned(phi, centres)
        rise = turned.real + (radii - self.follower.base_radius)
        slope = -self.rotation * turned.imag
        return self.outward * np.stack((rise, slope, -turned.real, -slope))

    def contact(self, phi: FloatArray, centres: ComplexArray, _: FloatArray) -> FloatArray:
        """(n,) [mm] place of the contact along the face, as of `FlatFollower`.

        NaN where a rocker's face cannot reach the circle.
        """
        return np.asarray(-self._turned(phi, centres).imag)

    def turning(self, centres: ComplexArray) -> FloatArray:
        """(2, n) cam angles [rad] at which the place of the contact with circles about `centres`
        (n,) is extreme: with the centre at the height of the cam axis.
        """
        angle = self.follower.guide_angle - np.angle(centres)
        return self.rotation * np.stack((angle - 0.5 * math.pi, angle + 0.5 * math.pi))

    def wander(self, touch: Touch) -> FloatArray:
        """(n,) how far the contact lies along the face per unit of the velocity of the lift."""
        return np.ones_like(touch.distance)


@dataclass(frozen=True, slots=True)
class RockingFace:
    """The face of an oscillating follower; the interface is that of `GuidedFace`."""

    follower: OscillatingFlat
    rotation: int

    @property
    def outward(self) -> int:
        return self.follower.arm_side * self.follower.swing_sense

    @property
    def _axis(self) -> float:
        """Angle of the line from the pivot to the cam axis [rad]."""
        return phase(-self.follower.pivot)

    def lift(self, distance: FloatArray) -> FloatArray:
        """See `GuidedFace`."""
        follower = self.follower
        sine = (distance - follower.face_offset) / follower.centre_distance
        if np.any(~(np.abs(sine) <= 1.0 + ROUNDING)):
            raise GeometryError(
                "the rocker's face cannot lie on the contour all round: the contour needs it at"
                f" {np.min(distance):.6g} to {np.max(distance):.6g} mm from the cam axis, and it"
                f" can be at {follower.face_offset - follower.centre_distance:.6g} to"
                f" {follower.farthest:.6g} mm"
            )
        chi = np.arcsin(np.clip(sine, -1.0, 1.0))
        return np.asarray(self.outward * (chi - follower.start_angle))

    def cam_angles(self, theta: FloatArray, lift: FloatArray) -> FloatArray:
        """See `GuidedFace`."""
        chi = self.follower.face_angle(lift)
        normal = self._axis + self.follower.arm_side * (chi + 0.5 * math.pi)
        return np.asarray(self.rotation * (normal - theta))

    def _seen(self, phi: FloatArray, centres: ComplexArray) -> ComplexArray:
        """(n,) complex [mm] from the pivot to the centres at `phi` (n,) [rad], in the axes of the
        line to the cam axis.
        """
        turned = centres * np.exp(1j * (self.rotation * phi - self._axis))
        return np.asarray(turned + self.follower.centre_distance)

    def jet(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """See `GuidedFace`.

        With g = V'/V the rates of arg V and ln |V| are its imaginary and its real part.
        """
        follower, side = self.follower, self.follower.arm_side
        arm = self._seen(phi, centres)
        reduced_offset = follower.face_offset - radii
        turned = arm - follower.centre_distance
        g = 1j * self.rotation * turned / arm
        share = turned / arm
        g1 = -share - g * g
        g2 = -g * (1.0 - share + 2.0 * g1)
        place = self.contact(phi, centres, radii)
        ratio = reduced_offset / place
        square = (np.abs(arm) / place) ** 2
        chi = side * np.angle(arm) - np.arctan(ratio)
        first = side * g.imag + ratio * g.real
        bend = g1.real - square * g.real * g.real
        second = side * g1.imag + ratio * bend
        # ratio' = -square Re(g) ratio, square' = 2 square (1 - square) Re(g)
        turn = g2.real - 2.0 * square * g.real * (g1.real + (1.0 - square) * g.real * g.real)
        third = side * g2.imag + ratio * (turn - square * g.real * bend)
        return self.outward * np.stack((chi - follower.start_angle, first, second, third))

    def contact(self, phi: FloatArray, centres: ComplexArray, radii: FloatArray) -> FloatArray:
        """See `GuidedFace`."""
        away, reduced_offset = (
            np.abs(self._seen(phi, centres)),
            np.abs(self.follower.face_offset - radii),
        )
        square = (away - reduced_offset) * (away + reduced_offset)
        return np.sqrt(np.where(square >= 0.0, square, np.nan))

    def turning(self, centres: ComplexArray) -> FloatArray:
        """See `GuidedFace`; the centre is on the line of centres, between axis and pivot first."""
        angle = self._axis + math.pi - np.angle(centres)
        return self.rotation * np.stack((angle, angle + math.pi))

    def wander(self, touch: Touch) -> FloatArray:
        """See `GuidedFace`: q = l_1 cos chi / tau."""
        return np.asarray(np.abs(touch.contact[0] / touch.turn[0]))


FacePath = GuidedFace | RockingFace


face_path_of.register(TranslatingFlat, GuidedFace)
face_path_of.register(OscillatingFlat, RockingFace)
