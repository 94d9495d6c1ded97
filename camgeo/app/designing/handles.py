"""Handles: points that can be dragged on a page, and what a drag changes in the scene.

A handle solves the inverse problem: which values put it where it is dropped.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from functools import singledispatch
from typing import Any, Final, Literal

import numpy as np

from camgeo.app.designing.form import (
    is_fixed,
    joints,
    key_title,
    least_span,
    motion_spans,
    neighbour_span,
    segment_span,
    span_key,
    step_near,
    styled,
)
from camgeo.cam.cam import Yoke
from camgeo.design.design import Design
from camgeo.errors import Fault, GeometryError, SceneError, UnknownNameError
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import Mount, OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import EXACT
from camgeo.numeric.arrays import phase
from camgeo.pictures.motion import PLAN
from camgeo.scene.keys import parse_path, spelled, tree_value
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER, TURN

FARTHEST: Final = 1e9
"""Largest magnitude of the coordinates of a place, as in a scene."""

LAST_POSITION: Final = re.compile(r"\[\d+\]$")

Place = tuple[float, float]
Edits = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Handle:
    """A point of a picture that can be dragged.

    Attributes
    ----------
    name : unique among the handles of a design.
    kind : of the point, e.g. "joint" or "pivot".
    space : of its coordinates: "plan", degrees and positions in the panel of the motion plan, or
        "mechanism", mm in the fixed frame at cam angle 0.
    panel : of the figure "motion", in the plan; 0 in the mechanism.
    place : where it is.
    moves : how it can be moved.
    values : the values that it changes: the `key` of each, its `label` and `unit`, and its `value`
        as the scene states it, or else its default.
    edits : maps a place, and steps in both directions, to the values of the scene that put the
        handle there, or as near as it can be. GeometryError for a place where it cannot be.
    """

    name: str
    kind: str
    space: Literal["plan", "mechanism"]
    panel: int
    place: Place
    moves: Moves
    values: tuple[dict[str, Any], ...]
    edits: Callable[[Place, Place], Edits] = field(repr=False)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the scene that it changes; for an item of a list, the key of the list."""
        return tuple(dict.fromkeys(LAST_POSITION.sub("", value["key"]) for value in self.values))

    def to_data(self) -> dict[str, Any]:
        """The handle as JSON data, without `edits`."""
        return {
            "name": self.name,
            "kind": self.kind,
            "space": self.space,
            "panel": self.panel,
            "at": list(self.place),
            "moves": self.moves,
            "label": self.name,
            "values": list(self.values),
        }


def handles(design: Design) -> Iterator[Handle]:
    """All handles of a design, those of the motion plan first."""
    yield from _plan_handles(design)
    for grip in _grips(design):
        yield _grip_handle(design.scene, grip)


FINEST: Final = 1e-6
"""Step if none is stated [length unit of the scene, or degrees]."""


def dragged(design: Design, name: str, target: Any, step: Any = None) -> tuple[Handle, Edits]:
    """The handle `name`, and the values of the scene with it dropped at `target`.

    Parameters
    ----------
    target : two coordinates, as those of `Handle.place`.
    step : values are rounded to multiples of it, in the units of `target`: a number, or one for
        each direction; None for the finest.

    Raises
    ------
    UnknownNameError
        If the design has no such handle.
    SceneError
        If `target` or `step` is not of that form, or the handle cannot be there.
    """
    handle = next((candidate for candidate in handles(design) if candidate.name == name), None)
    if handle is None:
        raise UnknownNameError(
            "handle", str(name)[:60], [candidate.name for candidate in handles(design)]
        )
    message = f"a handle is dropped at two numbers, [x, y], -{FARTHEST:g} to {FARTHEST:g}"
    place = _two(target, -FARTHEST, message)
    if step is None:
        step = FINEST
    steps = step if isinstance(step, list | tuple) else (step, step)
    try:
        edits = handle.edits(
            place, _two(steps, math.ulp(0.0), "a step is a positive number, or two")
        )
    except GeometryError as error:
        raise SceneError([Fault(error.key, error.value, error.message)]) from error
    return handle, edits


def _grips(design: Design) -> Iterator[Grip]:
    """The grips of the mechanism; none without a follower."""
    scene = design.scene
    if scene.follower is None:
        return
    yield from follower_grips(scene.follower, scene.yoke)
    if scene.mount is not None and scene.returning is not None:
        yield from return_grips(scene.follower, scene.mount, scene.returning)
    if scene.linkage is not None:
        yield from linkage_grips(scene.linkage, *design.disc.pictured.linkage_joint)


def _plan_handles(design: Design) -> Iterator[Handle]:
    """The handles of the motion plan."""
    scene = design.scene
    motion = scene.stated.scene.exact["motion"]
    angles = [float(angle) for angle in joints(motion_spans(motion) or ())]
    scale = math.degrees(1.0) if design.drive.unit == "rad" else 1.0 / MM_PER[scene.unit]
    # No segment begins at the last angle, the end of the turn.
    positions = scale * design.drive.plan.jet(np.radians(angles[:-1]))[0]
    unit = "°" if design.drive.unit == "rad" else scene.unit
    yield from _motion_handles(motion, positions.tolist(), unit)


def _grip_handle(scene: Scene, grip: Grip) -> Handle:
    unit = scene.unit
    now = grip.sizes(grip.place)
    values = []
    for key, size in now.items():
        label = key_title(parse_path(key) or ())
        present = _present_value(scene, key, size)
        if isinstance(present, list):
            parts = ("from", "to") if key.endswith("face") else ("x", "y")
            for number, (part, coordinate) in enumerate(zip(parts, present, strict=True), 1):
                values.append(_value(f"{key}[{number}]", f"{label} {part}", unit, coordinate))
        else:
            values.append(_value(key, label, "°" if size.arm else unit, present))

    def edits(target: Place, steps: Place) -> Edits:
        changes: dict[str, Any] = {}
        # Places are in mm, values in the unit of the scene; the finer step holds for both axes.
        step = min(steps) / MM_PER[unit]
        for key, size in grip.sizes(complex(*target)).items():
            present = _present_value(scene, key, now[key])
            value = _settled(scene, size, step, present)
            if value != present:
                changes[key] = value
        return changes

    place = grip.place.real, grip.place.imag
    return Handle(grip.name, grip.kind, "mechanism", 0, place, grip.moves, tuple(values), edits)


def _value(key: str, label: str, unit: str, value: Any) -> dict[str, Any]:
    return {"key": key, "label": label, "unit": unit, "value": float(value)}


def _present_value(scene: Scene, key: str, now: Size) -> Any:
    """The value that the scene states at `key`, or else the one that it has by default."""
    stated = tree_value(scene.stated.scene.exact, parse_path(key) or ())
    return _numbers(scene, now) if stated is None else stated


DIGITS: Final = 60
"""Digits with which a value is rounded: more than the largest number has in the smallest steps."""


def snapped(value: float, step: float, previous: Any = None) -> Any:
    """`value` rounded to a step of at most `step`, as a number of a scene.

    The number `previous`, which was there, is kept if it is within half a step of `value`. A whole
    number becomes an integer unless `previous` was written with a decimal point.
    """
    grid = step_near(step)
    if previous is not None and abs(value - float(previous)) <= 0.5 * float(grid):
        return previous
    with localcontext() as context:
        context.prec = DIGITS
        steps = (Decimal(value) / grid).quantize(Decimal(1), ROUND_HALF_EVEN)
        return styled(steps * grid, previous)


def _settled(scene: Scene, size: Size, step: float, previous: Any) -> Any:
    """The value of `size` in the unit of the scene, rounded to `step` [that unit]."""
    numbers = _numbers(scene, size)
    if isinstance(numbers, list):
        return [
            snapped(*arguments) for arguments in zip(numbers, (step, step), previous, strict=True)
        ]
    if size.arm:
        # The step is a length along the arc on which the grip turns.
        step = max(math.degrees(step * MM_PER[scene.unit] / size.arm), FINEST)
    return snapped(numbers, step, previous)


def _numbers(scene: Scene, size: Size) -> Any:
    """A size in the units of the scene; a point as a list of two."""
    if size.arm:
        return math.degrees(size.value)
    mm = MM_PER[scene.unit]
    return size.value / mm if size.second is None else [size.value / mm, size.second / mm]


def _two(value: Any, least: float, message: str) -> Place:
    """Two numbers from `least` to `FARTHEST` in data of any kind; SceneError if they are not."""
    numbers = tuple(value) if isinstance(value, list | tuple) else ()
    real = all(
        isinstance(number, int | float | Decimal) and not isinstance(number, bool)
        for number in numbers
    )
    if len(numbers) != 2 or not real or not all(least <= number <= FARTHEST for number in numbers):
        raise SceneError([Fault("", "", message)])
    return float(numbers[0]), float(numbers[1])


# -- grips ----------------------------------------------------------------------------------------
# Grips of a mechanism: points that can be gripped and moved, and what that changes.
#
# Every kind of follower and linkage has its own grips, at cam angle 0 in the fixed frame. Certain
# keys of the scene determine where a grip is. The grip inverts that: it returns the values of these
# keys for another place.


Moves = Literal["x", "y", "xy", "radial"]
"""How a handle moves: along an axis, freely, or on a line or circle of its own, to its point
nearest to the drop."""


@dataclass(frozen=True, slots=True)
class Size:
    """A length, an angle, a point or a range in a scene.

    Attributes
    ----------
    value : length [mm] or angle [rad].
    arm : for an angle, distance [mm] of the grip from its centre of rotation; 0 for lengths.
    second : the second of two lengths [mm], for a point or a range.
    """

    value: float
    arm: float = 0.0
    second: float | None = None


def point(place: complex) -> Size:
    """The size that states a point [mm]."""
    return Size(place.real, second=place.imag)


Sizes = Mapping[str, Size]
"""Values by the keys of the scene."""


@dataclass(frozen=True, slots=True, eq=False)
class Grip:
    """A point of the mechanism that can be moved.

    Attributes
    ----------
    name : unique among the grips of the mechanism.
    kind : of the point, e.g. "pivot" or "roller".
    place : where it is [mm].
    moves : how it can be moved.
    sizes : maps a place [mm] to the values that put the grip there, or as near as it can move.
        GeometryError for a place where it cannot be.
    """

    name: str
    kind: str
    place: complex
    moves: Moves
    sizes: Callable[[complex], Sizes]


@singledispatch
def follower_grips(follower: Follower, yoke: Yoke | None) -> Iterator[Grip]:
    """The grips of a follower; with a `yoke` it has no offset.

    A class of followers for which none are registered has none.
    """
    del follower, yoke
    yield from ()


@follower_grips.register
def _(follower: TranslatingRoller, yoke: Yoke | None) -> Iterator[Grip]:
    outward = follower.outward

    def centre(target: complex) -> Sizes:
        seen = target * outward.conjugate()
        # Seen from the cam axis, along the guide (real) and across it (imaginary).
        if seen.real <= 0.0:
            raise GeometryError("must stay on its side of the cam axis", "follower.base_radius", "")
        return {"follower.base_radius": Size(abs(target)), "follower.offset": Size(-seen.imag)}

    yield _base_circle(follower, -outward, yoke)
    if yoke is None:
        yield Grip("roller centre", "arm", follower.start_arm, "xy", centre)
    yield from _roller("roller", "follower.", follower.start_arm, follower)
    yield _guide(follower, follower.guide_angle)


@follower_grips.register
def _(follower: OscillatingRoller, _: Yoke | None) -> Iterator[Grip]:
    pivot, here = follower.pivot, follower.pivot + follower.start_arm

    def centre(target: complex) -> Sizes:
        arm = target - pivot
        if _side(-pivot, arm) != follower.arm_side:
            raise GeometryError(
                "must stay on its side of the line from the pivot to the cam axis",
                "follower.arm_side", "",
            )  # fmt: skip
        return {"follower.arm": Size(abs(arm)), "follower.base_radius": Size(abs(target))}

    yield _pivot(pivot)
    yield _base_circle(follower, -pivot, None)
    yield Grip("roller centre", "arm", here, "xy", centre)
    yield from _roller("roller", "follower.", here, follower)


@follower_grips.register
def _(follower: TranslatingFlat, yoke: Yoke | None) -> Iterator[Grip]:
    outward = follower.outward

    def face(target: complex) -> Sizes:
        return _base_radius(follower, (target * outward.conjugate()).real, yoke)

    yield _base_circle(follower, -outward, yoke)
    yield Grip("face", "base-circle", follower.base_radius * outward, "radial", face)
    yield from _face_ends(follower)
    yield _guide(follower, follower.guide_angle)


@follower_grips.register
def _(follower: OscillatingFlat, _: Yoke | None) -> Iterator[Grip]:
    pivot, foot = follower.pivot, follower.pivot + follower.start_arm
    sign = math.copysign(1.0, follower.face_offset)

    def offset(target: complex) -> Sizes:
        return {"follower.face_offset": Size(sign * abs(target - pivot))}

    yield _pivot(pivot)
    yield _base_circle(follower, -pivot, None)
    if follower.face_offset:
        yield Grip("face offset", "face", foot, "radial", offset)
    yield from _face_ends(follower)


@singledispatch
def return_grips(follower: Follower, mount: Mount, returning: Follower) -> Iterator[Grip]:
    """The grips of the second roller of a conjugate pair, whose main one is `follower`.

    A class of followers for which none are registered has none.
    """
    del follower, mount, returning
    yield from ()


@return_grips.register
def _(follower: TranslatingRoller, _: Mount, returning: Follower) -> Iterator[Grip]:
    outward = follower.outward

    def centre(target: complex) -> Sizes:
        seen = target * outward.conjugate()
        return {
            "follower.return.spacing": Size(follower.start_height - seen.real),
            "follower.return.offset": Size(-seen.imag),
        }

    here = returning.start_arm
    yield Grip("return roller centre", "arm", here, "xy", centre)
    yield from _roller("return roller", "follower.return.", here, returning)


@return_grips.register
def _(follower: OscillatingRoller, mount: Mount, returning: Follower) -> Iterator[Grip]:
    pivot, arm, now = follower.pivot, returning.start_arm, dict(mount.arguments)["arm_angle"]

    def centre(target: complex) -> Sizes:
        new_arm = target - pivot
        angle = reduce_angle(now + phase(new_arm / arm))
        return {
            "follower.return.arm": Size(abs(new_arm)),
            "follower.return.arm_angle": Size(angle, abs(new_arm)),
        }

    yield Grip("return roller centre", "arm", pivot + arm, "xy", centre)
    yield from _roller("return roller", "follower.return.", pivot + arm, returning)


def _pivot(pivot: complex) -> Grip:
    return Grip("pivot", "pivot", pivot, "xy", lambda target: {"follower.pivot": point(target)})


def _base_circle(follower: Follower, way: complex, yoke: Yoke | None) -> Grip:
    """The base circle, gripped on the side away from the follower."""
    place = follower.base_radius * way / abs(way)
    return Grip(
        "base circle", "base-circle", place, "radial",
        lambda target: _base_radius(follower, abs(target), yoke),
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
        yield Grip(name, "roller", rim, "radial", lambda target: {key: Size(abs(target - centre))})


def _guide(follower: Follower, angle: float) -> Grip:
    """The guide, which turns about the cam axis."""
    place = follower.held((0.0, 0.0))[1]

    def turned(target: complex) -> Sizes:
        new = reduce_angle(angle + phase(target / place))
        return {"follower.guide_angle": Size(new, abs(place))}

    return Grip("guide", "guide", place, "radial", turned)


def _face_ends(follower: Follower) -> Iterator[Grip]:
    """Both ends of a face, if its length is stated."""
    line = follower.held((0.0, 1.0))[2]
    if follower.face is None or line is None:
        return
    foot, way = line[0], line[1] - line[0]
    start, end = follower.face

    def first(target: complex) -> Sizes:
        return {"follower.face": Size(((target - foot) * way.conjugate()).real, second=end)}

    def last(target: complex) -> Sizes:
        return {"follower.face": Size(start, second=((target - foot) * way.conjugate()).real)}

    yield Grip("face start", "face", foot + start * way, "radial", first)
    yield Grip("face end", "face", foot + end * way, "radial", last)


def reduce_angle(angle: float) -> float:
    """The angle [rad] if it is within -2 pi to 2 pi, else the same direction within -pi to pi."""
    return angle if abs(angle) <= TURN else math.remainder(angle, TURN)


def _side(line: complex, arm: complex) -> float:
    """+1 if `arm` points counter-clockwise of `line`, -1 clockwise, 0 along it."""
    return float(np.sign((arm * line.conjugate()).imag))


# -- linkage grips --------------------------------------------------------------------------------
# Grips of linkages, see `camgeo.app.designing.handles`.


PARALLEL = 1e-6
"""Largest tilt [rad] of a coupler that counts as parallel to the guide at the start, as its
dimensions require."""

ACROSS = "must stay on its side of the shaft"


@singledispatch
def linkage_grips(linkage: Linkage, place: complex, outward: complex) -> Iterator[Grip]:
    """The grips of a linkage that takes hold of the follower at `place` [mm].

    `outward` is the direction of the follower's guide, 0 for a rocker. A class of linkages for
    which none are registered has none.
    """
    del linkage, place, outward
    yield from ()


@linkage_grips.register
def _(linkage: FourBar, place: complex, _: complex) -> Iterator[Grip]:
    seen_pin, seen_tip = (complex(joint[0]) for joint in linkage.joints(np.zeros(1)))
    shaft, pin, tip = place + linkage.shaft, place + seen_pin, place + seen_tip

    def crank(target: complex) -> Sizes:
        # The cross product of pin and tip, seen from the rocker shaft, whose sign the branch
        # determines.
        side = (seen_pin.conjugate() * (target - place)).imag
        if side * linkage.branch >= 0.0:
            raise GeometryError(
                "must stay on its side of the line from the rocker shaft to the lever's pin",
                "linkage.branch",
            )
        return {
            "linkage.crank": Size(abs(target - place)),
            "linkage.coupler": Size(abs(pin - target)),
        }

    def lever(target: complex) -> Sizes:
        angle = reduce_angle(linkage.lever_angle + phase((target - shaft) / (pin - shaft)))
        length = abs(target - shaft)
        return {"linkage.lever": Size(length), "linkage.lever_angle": Size(angle, length)}

    yield Grip("crank", "joint", tip, "xy", crank)
    yield Grip("lever", "joint", pin, "xy", lever)
    yield Grip(
        "shaft", "pivot", shaft, "xy", lambda target: {"linkage.shaft": point(target - place)}
    )


@linkage_grips.register
def _(linkage: SliderCrank, place: complex, _: complex) -> Iterator[Grip]:
    if linkage.coupler_tilt > PARALLEL:
        return
    pin, tip = (place + complex(joint[0]) for joint in linkage.joints(np.zeros(1)))
    yield Grip("crank", "joint", tip, "xy", lambda target: _crank(linkage, target - place))
    yield Grip(
        "slider", "joint", pin, "x", lambda target: _coupler((target - tip).real, (pin - tip).real)
    )


@linkage_grips.register
def _(linkage: SliderDrivenCrank, place: complex, outward: complex) -> Iterator[Grip]:
    inner = linkage.inner
    if inner.coupler_tilt > PARALLEL:
        return
    # Multiplied by it, coordinates along and across the guide become those of the fixed frame.
    turn = outward * inner.slider_sense
    seen_pin, seen_tip = (complex(joint[0]) for joint in inner.joints(np.zeros(1)))
    shaft = place - turn * seen_pin

    def crank(target: complex) -> Sizes:
        # How far the pictured rod reaches along the guide depends on the stroke, and so on these.
        across = ((target - place) * turn.conjugate()).imag
        return _crank(inner, complex(seen_tip.real, -across))

    yield Grip("crank", "pivot", shaft, "radial", crank)


def _crank(linkage: SliderCrank, tip: complex) -> Sizes:
    """The crank whose tip is at `tip` [mm] from its shaft, with the guide along x above it."""
    if tip.imag <= 0.0:
        raise GeometryError(ACROSS, "linkage.crank_deflection")
    # The deflection is counted from the perpendicular to the guide; the scene states which way it
    # leans.
    lean = linkage.slider_side if linkage.leans_away else -linkage.slider_side
    deflection = math.atan2(-lean * tip.real if linkage.mirrored else lean * tip.real, tip.imag)
    length = abs(tip)
    return {"linkage.crank": Size(length), "linkage.crank_deflection": Size(deflection, length)}


def _coupler(reach: float, present: float) -> Sizes:
    """The coupler that reaches `reach` [mm] along the guide, on the same side as `present`."""
    if reach * present <= 0.0:
        raise GeometryError("must stay on its side of the crank's tip", "linkage.coupler")
    return {"linkage.coupler": Size(abs(reach))}


# -- joints ---------------------------------------------------------------------------------------
# Handles of the motion plan: its joints, and the points of motions through points.


MOST: Final = 400
"""Most handles of a plan; in a longer one only the first points have handles."""


def _motion_handles(
    motion: list[dict[str, Any]], positions: Sequence[float], unit: str
) -> Iterator[Handle]:
    """The movable points of a valid motion, from its segments as stated and the `positions`
    [`unit`] at which they start.

    The first joint cannot move, because the motion starts at 0.
    """
    spans = motion_spans(motion)
    assert spans is not None  # it is valid
    angles = joints(spans)
    last = max((k for k, segment in enumerate(motion) if "dwell" not in segment), default=-1)
    count = 0
    level: tuple[int, Any] | None = None
    for index, segment in enumerate(motion):
        # After a segment of zero span a joint coincides with the previous one.
        if index and count < MOST and (spans[index - 1] or index == 1):
            joint = _joint(motion, index, angles, level, last, positions[index], unit)
            if joint is not None:
                count += 1
                yield joint
        for number in range(min(len(segment.get("points", ())), MOST - count)):
            count += 1
            yield _point(motion, index, number, angles[index], unit)
        if "dwell" not in segment:
            level = index, segment.get("to")


def _joint(
    motion: list[dict[str, Any]],
    index: int,
    angles: list[Decimal],
    level: tuple[int, Any] | None,
    last: int,
    position: float,
    unit: str,
) -> Handle | None:
    """The joint at which the segment `index` begins; None if it cannot move.

    `level` is the last segment before it that is not a dwell, with the stated position of its end;
    `position` is that position as a number.
    """
    first, second = motion[index - 1], motion[index]
    fixed = is_fixed(first) or is_fixed(second)
    mover, stated_end = level if level is not None else (-1, 0)
    # A file determines where a table ends, and the last move has to return to 0.
    rises = stated_end is not None and mover >= 0 and mover != last
    moves: Moves | None = ("y" if rises else None) if fixed else ("xy" if rises else "x")
    if moves is None:
        return None
    keys: dict[str, str] = {}
    span_place = spelled(("motion", index - 1, span_key(first)))
    other_place = spelled(("motion", index, span_key(second)))
    to_place = spelled(("motion", mover, "to"))
    if not fixed:
        keys[span_place] = f"span of segment {index}"
    if rises:
        keys[to_place] = "position"

    def edits(place: Place, steps: Place) -> Edits:
        changes: dict[str, Any] = {}
        if not fixed:
            start, now, end = angles[index - 1 : index + 2]
            with localcontext(EXACT):
                # No nearer to its neighbours than a step, unless it is now.
                grid = step_near(steps[0])
                low = min(start + max(least_span(first), grid), now)
                high = max(end - max(least_span(second), grid), now)
                new = min(max(Decimal(snapped(place[0], steps[0], now)), low), high)
                span = new - start
            if new != now:
                changes[span_place] = styled(span, first[span_key(first)])
                other = neighbour_span(first, second, span)
                changes[other_place] = styled(other, second[span_key(second)])
        if rises:
            changes[to_place] = snapped(place[1], steps[1], stated_end)
        return changes

    height = position if stated_end is None else float(stated_end)
    place = float(angles[index]), height
    return _handle(motion, f"joint {index + 1}", "joint", place, moves, keys, unit, edits)


def _point(
    motion: list[dict[str, Any]], index: int, number: int, start: Decimal, unit: str
) -> Handle:
    """A point of a motion through points, between its neighbours."""
    points = motion[index]["points"]
    stated = points[number]
    span = segment_span(motion[index])
    low = Decimal(points[number - 1]["at"]) if number else Decimal(0)
    high = Decimal(points[number + 1]["at"]) if number + 1 < len(points) else span
    assert high is not None  # it is valid
    angle_key = spelled(("motion", index, "points", number, "at"))
    position_key = spelled(("motion", index, "points", number, "to"))

    def edits(place: Place, steps: Place) -> Edits:
        now = Decimal(stated["at"])
        with localcontext(EXACT):
            grid = step_near(steps[0])
            new = Decimal(snapped(place[0] - float(start), steps[0], now))
            # At least one step from its neighbours, unless it is nearer to them already.
            new = min(max(new, min(low + grid, now)), max(high - grid, now))
        changes: dict[str, Any] = {} if new == now else {angle_key: styled(new, stated["at"])}
        changes[position_key] = snapped(place[1], steps[1], stated["to"])
        return changes

    location = float(start + Decimal(stated["at"])), float(stated["to"])
    keys = {angle_key: "cam angle in the segment", position_key: "position"}
    name = f"point {index + 1}.{number + 1}"
    return _handle(motion, name, "point", location, "xy", keys, unit, edits)


def _handle(
    motion: list[dict[str, Any]],
    name: str,
    kind: str,
    place: Place,
    moves: Moves,
    keys: Mapping[str, str],
    unit: str,
    edits: Callable[[Place, Place], Edits],
) -> Handle:
    """The handle of a point of a motion; those of its `edits` that change nothing are left out.

    `keys` are the keys of the scene that it changes, with their labels.
    """

    def stated(key: str) -> Any:
        return tree_value({"motion": motion}, parse_path(key) or ())

    def differing(target: Place, steps: Place) -> Edits:
        changes = edits(target, steps)
        return {key: value for key, value in changes.items() if value is not stated(key)}

    values = tuple(
        _value(key, label, unit if key.endswith(".to") else "°", stated(key))
        for key, label in keys.items()
    )
    return Handle(name, kind, "plan", PLAN, place, moves, values, differing)
