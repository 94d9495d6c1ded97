"""Grips of a mechanism: points that can be gripped and moved, and what that changes.

Every kind of follower and linkage has its own, at cam angle 0 in the fixed frame. Certain keys of
the scene determine where a grip is. It knows the inverse: the values of these keys with which it
would be elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import singledispatch
from typing import Literal

import numpy as np

from camgeo.cam.breadth import Yoke
from camgeo.errors import GeometryError
from camgeo.mechanism.conjugate import Mount
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.oscillating_flat import OscillatingFlat
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_flat import TranslatingFlat
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import phase
from camgeo.units import TURN

Moves = Literal["x", "y", "xy", "radial"]
"""How a handle moves: along an axis, freely, or on a line or circle of its own, to the point there
that is nearest to the drop."""


@dataclass(frozen=True, slots=True)
class Size:
    """A value of a scene.

    Attributes
    ----------
    value : length [mm] or angle [rad].
    second : the second of two lengths, for a point or a range.
    arm : of an angle, distance [mm] at which it turns the grip; 0 for lengths.
    """

    value: float
    arm: float = 0.0
    second: float | None = None


def point(at: complex) -> Size:
    """The coordinates [mm] of a point."""
    return Size(at.real, second=at.imag)


Sizes = Mapping[str, Size]
"""Values by the keys of the scene."""


@dataclass(frozen=True, slots=True, eq=False)
class Grip:
    """A point of the mechanism that can be moved.

    Attributes
    ----------
    name : its own among all of the mechanism.
    kind : what it is, e.g. "pivot" or "roller".
    at : where it is [mm].
    moves : how it can be moved.
    sizes : the values with which it is at a place [mm], or as near to that as it can move.
        GeometryError for a place where it cannot be.
    """

    name: str
    kind: str
    at: complex
    moves: Moves
    sizes: Callable[[complex], Sizes]


@singledispatch
def grips_of(follower: Follower, yoke: Yoke | None) -> Iterator[Grip]:
    """The grips of a follower, perhaps with a `yoke`, and then without an offset.

    None unless they are registered for its class.
    """
    del follower, yoke
    yield from ()


@grips_of.register
def _(follower: TranslatingRoller, yoke: Yoke | None) -> Iterator[Grip]:
    outward = follower.outward

    def centre(to: complex) -> Sizes:
        seen = to * outward.conjugate()
        if seen.real <= 0.0:
            raise GeometryError("must stay on its side of the cam axis", "follower.base_radius", "")
        return {"follower.base_radius": Size(abs(to)), "follower.offset": Size(-seen.imag)}

    yield _base_circle(follower, -outward, yoke)
    if yoke is None:
        yield Grip("roller centre", "arm", follower.start_arm, "xy", centre)
    yield from _roller("roller", "follower.", follower.start_arm, follower)
    yield _guide(follower, follower.guide_angle)


@grips_of.register
def _(follower: OscillatingRoller, yoke: Yoke | None) -> Iterator[Grip]:
    del yoke
    pivot, here = follower.pivot, follower.pivot + follower.start_arm

    def centre(to: complex) -> Sizes:
        arm = to - pivot
        if _side(-pivot, arm) != follower.arm_side:
            raise GeometryError(
                "must stay on its side of the line from the pivot to the cam axis",
                "follower.arm_side", "",
            )  # fmt: skip
        return {"follower.arm": Size(abs(arm)), "follower.base_radius": Size(abs(to))}

    yield _pivot(pivot)
    yield _base_circle(follower, -pivot, None)
    yield Grip("roller centre", "arm", here, "xy", centre)
    yield from _roller("roller", "follower.", here, follower)


@grips_of.register
def _(follower: TranslatingFlat, yoke: Yoke | None) -> Iterator[Grip]:
    outward = follower.outward

    def face(to: complex) -> Sizes:
        return _base_radius(follower, (to * outward.conjugate()).real, yoke)

    yield _base_circle(follower, -outward, yoke)
    yield Grip("face", "base-circle", follower.base_radius * outward, "radial", face)
    yield from _face_ends(follower)
    yield _guide(follower, follower.guide_angle)


@grips_of.register
def _(follower: OscillatingFlat, yoke: Yoke | None) -> Iterator[Grip]:
    del yoke
    pivot, foot = follower.pivot, follower.pivot + follower.start_arm
    sign = math.copysign(1.0, follower.face_offset)

    def offset(to: complex) -> Sizes:
        return {"follower.face_offset": Size(sign * abs(to - pivot))}

    yield _pivot(pivot)
    yield _base_circle(follower, -pivot, None)
    if follower.face_offset:
        yield Grip("face offset", "face", foot, "radial", offset)
    yield from _face_ends(follower)


def return_grips(follower: Follower, mount: Mount, returning: Follower) -> Iterator[Grip]:
    """The grips of the second roller of a conjugate pair, whose main one is `follower`."""
    yield from _returning(follower, dict(mount.given), returning)


@singledispatch
def _returning(
    follower: Follower, given: Mapping[str, float], returning: Follower
) -> Iterator[Grip]:
    del follower, given, returning
    yield from ()


@_returning.register
def _(
    follower: TranslatingRoller, given: Mapping[str, float], returning: Follower
) -> Iterator[Grip]:
    del given
    outward = follower.outward

    def centre(to: complex) -> Sizes:
        seen = to * outward.conjugate()
        return {
            "follower.return.spacing": Size(follower.start_height - seen.real),
            "follower.return.offset": Size(-seen.imag),
        }

    yield Grip("return roller centre", "arm", returning.start_arm, "xy", centre)
    here = returning.start_arm
    yield from _roller("return roller", "follower.return.", here, returning)


@_returning.register
def _(
    follower: OscillatingRoller, given: Mapping[str, float], returning: Follower
) -> Iterator[Grip]:
    pivot, arm = follower.pivot, returning.start_arm

    def centre(to: complex) -> Sizes:
        own = to - pivot
        angle = within_a_turn(given["arm_angle"] + phase(own / arm))
        return {
            "follower.return.arm": Size(abs(own)),
            "follower.return.arm_angle": Size(angle, abs(own)),
        }

    yield Grip("return roller centre", "arm", pivot + arm, "xy", centre)
    yield from _roller("return roller", "follower.return.", pivot + arm, returning)


def _pivot(pivot: complex) -> Grip:
    return Grip("pivot", "pivot", pivot, "xy", lambda to: {"follower.pivot": point(to)})


def _base_circle(follower: Follower, way: complex, yoke: Yoke | None) -> Grip:
    """The base circle, gripped on the side away from the follower."""
    at = follower.base_radius * way / abs(way)
    return Grip(
        "base circle", "base-circle", at, "radial",
        lambda to: _base_radius(follower, abs(to), yoke),
    )  # fmt: skip


def _base_radius(follower: Follower, radius: float, yoke: Yoke | None) -> Sizes:
    """The base radius, and the breadth of a yoke, whose two sides both move by the same amount."""
    sizes = {"follower.base_radius": Size(radius)}
    if yoke is not None and yoke.breadth is not None:
        breadth = yoke.breadth + 2.0 * (radius - follower.base_radius)
        sizes["follower.yoke.breadth"] = Size(breadth)
    return sizes


def _roller(name: str, table: str, centre: complex, follower: Follower) -> Iterator[Grip]:
    """The rim of a roller, on the side away from the cam; none for a knife edge.

    It is at the height of the centre, so that the two targets are as far apart as possible.
    """
    if follower.roller_radius:
        rim = centre + math.copysign(follower.roller_radius, centre.real)
        key = f"{table}roller_radius"
        yield Grip(name, "roller", rim, "radial", lambda to: {key: Size(abs(to - centre))})


def _guide(follower: Follower, angle: float) -> Grip:
    """The guide, which turns about the cam axis."""
    at = follower.held((0.0, 0.0))[1]

    def turned(to: complex) -> Sizes:
        new = within_a_turn(angle + phase(to / at))
        return {"follower.guide_angle": Size(new, abs(at))}

    return Grip("guide", "guide", at, "radial", turned)


def _face_ends(follower: Follower) -> Iterator[Grip]:
    """Both ends of a face, if its length is stated."""
    line = follower.held((0.0, 1.0))[2]
    if follower.face is None or line is None:
        return
    foot, way = line[0], line[1] - line[0]
    start, end = follower.face

    def first(to: complex) -> Sizes:
        return {"follower.face": Size(((to - foot) * way.conjugate()).real, second=end)}

    def last(to: complex) -> Sizes:
        return {"follower.face": Size(start, second=((to - foot) * way.conjugate()).real)}

    yield Grip("face start", "face", foot + start * way, "radial", first)
    yield Grip("face end", "face", foot + end * way, "radial", last)


def within_a_turn(angle: float) -> float:
    """The same direction from -2 pi to 2 pi."""
    return angle if abs(angle) <= TURN else math.remainder(angle, TURN)


def _side(line: complex, arm: complex) -> float:
    """+1 if `arm` points counter-clockwise of `line`, -1 clockwise, 0 along it."""
    return float(np.sign((arm * line.conjugate()).imag))
