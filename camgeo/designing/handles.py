"""Handles: what can be dragged on a page, and what a drag changes in the scene.

A handle knows the inverse: the values with which it is at the place where it is dropped.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any, Final, Literal

import numpy as np

from camgeo.design import Design
from camgeo.designing.grips import Grip, Moves, Size, grips_of, return_grips
from camgeo.designing.joints import Pull, pulls
from camgeo.designing.labels import title_of
from camgeo.designing.linkage_grips import linkage_grips
from camgeo.designing.snapping import FINEST, snapped
from camgeo.designing.spans import joints, spans_of
from camgeo.errors import Fault, GeometryError, SceneError, UnknownNameError
from camgeo.figure.motion_plan import PLAN
from camgeo.scene.keys import path_of, value_at
from camgeo.scene.scene import Scene
from camgeo.units import MM_PER

FARTHEST: Final = 1e9
"""Magnitude of the coordinates of a place, as of a scene."""

LAST_POSITION: Final = re.compile(r"\[\d+\]$")

Place = tuple[float, float]
Edits = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Value:
    """A value that a handle changes.

    Attributes
    ----------
    key : of the scene.
    label, unit : what it is called, and its unit.
    value : as the scene states it, or what it is if the scene does not state it.
    """

    key: str
    label: str
    unit: str
    value: float


@dataclass(frozen=True, slots=True, eq=False)
class Handle:
    """A point of a picture that can be dragged.

    Attributes
    ----------
    name : its own among all of a design.
    kind : what it is, e.g. "joint" or "pivot".
    space : of its coordinates: "plan", degrees and positions in the panel of the motion plan, or
        "mechanism", mm in the fixed frame at cam angle 0.
    panel : of the figure "motion", in the plan; 0 in the mechanism.
    at : where it is.
    moves : how it can be moved.
    label : what people call it.
    values : what it changes.
    edits : the values of the scene with which it is at a place, or as near as it can be, rounded
        to steps in both directions. GeometryError for a place where it cannot be.
    """

    name: str
    kind: str
    space: Literal["plan", "mechanism"]
    panel: int
    at: Place
    moves: Moves
    label: str
    values: tuple[Value, ...]
    edits: Callable[[Place, Place], Edits] = field(repr=False)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the scene that it changes; for an item of a list, the key of the list."""
        return tuple(dict.fromkeys(LAST_POSITION.sub("", each.key) for each in self.values))

    def to_data(self) -> dict[str, Any]:
        """For JSON, without `edits`."""
        return {
            "name": self.name,
            "kind": self.kind,
            "space": self.space,
            "panel": self.panel,
            "at": list(self.at),
            "moves": self.moves,
            "label": self.label,
            "values": [
                {"key": each.key, "label": each.label, "unit": each.unit, "value": each.value}
                for each in self.values
            ],
        }


def handles(design: Design) -> tuple[Handle, ...]:
    """All handles of a design, those of its motion plan first."""
    return tuple(_handles(design))


def _handles(design: Design) -> Iterator[Handle]:
    yield from _of_plan(design)
    for each in _grips(design):
        yield _of_grip(design.scene, each)


def dragged(design: Design, name: str, to: Any, step: Any = None) -> tuple[Handle, Edits]:
    """The handle `name`, and the values of the scene with it dropped at `to`.

    Parameters
    ----------
    to : two coordinates, as those of `Handle.at`.
    step : to whose multiples values are rounded, in the units of `to`: a number, or one for each
        direction; None for the finest.

    Raises
    ------
    UnknownNameError
        If the design has no such handle.
    SceneError
        If `to` or `step` is not of that form, or the handle cannot be there.
    """
    handle = next((each for each in _handles(design) if each.name == name), None)
    if handle is None:
        raise UnknownNameError("handle", str(name)[:60], [each.name for each in handles(design)])
    place = _place(to)
    try:
        edits = handle.edits(place, _steps(step))
    except GeometryError as error:
        raise SceneError([Fault(error.key, error.value, error.message)]) from error
    return handle, edits


def _grips(design: Design) -> Iterator[Grip]:
    """The grips of the mechanism; none without a follower."""
    scene = design.scene
    if scene.follower is None:
        return
    yield from grips_of(scene.follower, scene.yoke)
    if scene.mount is not None and scene.returning is not None:
        yield from return_grips(scene.follower, scene.mount, scene.returning)
    if scene.linkage is not None:
        yield from linkage_grips(scene.linkage, *design.disc.pictured.linked_at)


def _of_plan(design: Design) -> Iterator[Handle]:
    """The handles of the motion plan."""
    scene = design.scene
    motion = scene.stated.scene.exact["motion"]
    angles = [float(each) for each in joints(spans_of(motion) or ())]
    scale = math.degrees(1.0) if design.drive.unit == "rad" else 1.0 / MM_PER[scene.unit]
    positions = scale * design.drive.plan.jet(np.radians(angles[:-1]))[0]
    unit = "°" if design.drive.unit == "rad" else scene.unit
    for pull in pulls(motion, positions.tolist()):
        yield _of_pull(motion, pull, unit)


def _of_pull(motion: list[Any], pull: Pull, unit: str) -> Handle:
    values = []
    for key, label in pull.keys.items():
        of_position = key.endswith(".to")
        found = value_at({"motion": motion}, path_of(key) or ())
        values.append(Value(key, label, unit if of_position else "°", float(found)))

    def edits(to: Place, steps: Place) -> Edits:
        found = pull.edits(to, steps)
        before = {key: value_at({"motion": motion}, path_of(key) or ()) for key in found}
        return {key: value for key, value in found.items() if value is not before[key]}

    return Handle(
        pull.name, pull.kind, "plan", PLAN, pull.at, pull.moves, pull.name, tuple(values), edits
    )


def _of_grip(scene: Scene, grip: Grip) -> Handle:
    unit = scene.unit
    now = grip.sizes(grip.at)
    values = []
    for key, size in now.items():
        label = title_of(path_of(key) or ())
        before = _before(scene, key, size)
        if isinstance(before, list):
            for number, each in enumerate(before):
                name = f"{label} {_part(key, number)}"
                values.append(Value(f"{key}[{number + 1}]", name, unit, float(each)))
        else:
            values.append(Value(key, label, "°" if size.arm else unit, float(before)))

    def edits(to: Place, steps: Place) -> Edits:
        found: dict[str, Any] = {}
        step = min(steps) / MM_PER[unit]
        for key, size in grip.sizes(complex(*to)).items():
            before = _before(scene, key, now[key])
            value = _settled(scene, size, step, before)
            if value != before:
                found[key] = value
        return found

    at = grip.at.real, grip.at.imag
    return Handle(
        grip.name, grip.kind, "mechanism", 0, at, grip.moves, grip.name, tuple(values), edits
    )


def _part(key: str, number: int) -> str:
    return ("from", "to")[number] if key.endswith("face") else ("x", "y")[number]


def _before(scene: Scene, key: str, now: Size) -> Any:
    """The value that the scene states at `key`, or else the one that it has by default."""
    stated = value_at(scene.stated.scene.exact, path_of(key) or ())
    return _numbers(scene, now) if stated is None else stated


def _settled(scene: Scene, size: Size, step: float, before: Any) -> Any:
    """The value of `size` as the scene states it, rounded."""
    found = _numbers(scene, size)
    if isinstance(found, list):
        return [snapped(*each) for each in zip(found, (step, step), before, strict=True)]
    if size.arm:
        step = max(math.degrees(step * MM_PER[scene.unit] / size.arm), FINEST)
    return snapped(found, step, before)


def _numbers(scene: Scene, size: Size) -> Any:
    """A size in the units of the scene; a point as a list of two."""
    if size.arm:
        return math.degrees(size.value)
    mm = MM_PER[scene.unit]
    return size.value / mm if size.second is None else [size.value / mm, size.second / mm]


def _place(to: Any) -> Place:
    """Two coordinates that may come from anywhere; SceneError if they are none."""
    found = tuple(to) if isinstance(to, list | tuple) else ()
    if len(found) != 2 or not all(_is_number(each) and abs(each) <= FARTHEST for each in found):
        message = f"a handle is dropped at two numbers, [x, y], -{FARTHEST:g} to {FARTHEST:g}"
        raise SceneError([Fault("", "", message)])
    return float(found[0]), float(found[1])


def _steps(step: Any) -> Place:
    """The steps of both coordinates; SceneError if `step` states none."""
    found = tuple(step) if isinstance(step, list | tuple) else (step, step)
    if step is None:
        return FINEST, FINEST
    if len(found) != 2 or not all(_is_number(each) and each > 0.0 for each in found):
        raise SceneError([Fault("", "", "a step is a positive number, or two")])
    return float(found[0]), float(found[1])


def _is_number(value: Any) -> bool:
    real = isinstance(value, int | float | Decimal) and not isinstance(value, bool)
    return real and abs(value) <= FARTHEST
