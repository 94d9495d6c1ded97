"""The tolerances that a scene states in `[tolerance]`, with its units converted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from camgeo.design import Design
from camgeo.errors import GeometryError, SceneError, meant
from camgeo.outline.path import Flank
from camgeo.scene.keys import Path, spelled
from camgeo.scene.scene import Scene
from camgeo.scene.tolerance_rules import TOLERANCE
from camgeo.tolerancing.dimensions import Dimension, dimensions_of
from camgeo.tolerancing.distribution import Distribution, Shape
from camgeo.tolerancing.freedoms import Hold
from camgeo.tolerancing.iso286 import PER_MM, is_hole, limits_of
from camgeo.tolerancing.machine import Machine
from camgeo.tolerancing.sources import (
    Fit,
    FormError,
    LooseClearance,
    PressedClearance,
    Source,
    ToleratedDimension,
)
from camgeo.units import MM_PER
from camgeo.wording import listed

Table = Mapping[str, Any]


@dataclass(frozen=True)
class Stated:
    """What a scene states.

    Attributes
    ----------
    machine : the nominal one; of a follower that two sides hold, where the main one carries it.
    second : the same where the other side carries it; None if there is none.
    sources : of deviations, in the order of the scene.
    limit : largest error of the position that is allowed [mm or rad]; None if there is none.
    set_at : cam angle [rad] at which the error is set to 0; None if it is not.
    """

    machine: Machine
    second: Machine | None
    sources: tuple[Source, ...]
    limit: float | None
    set_at: float | None


def stated_of(design: Design) -> Stated:
    """The tolerances of a design's scene.

    Raises
    ------
    SceneError
        If it states none, a key that is no dimension of the machine, with the nearest one, an
        unknown tolerance class, a fit without clearance, or a side that the follower has not.
    GeometryError
        If its kind of machine, or its flank, cannot be analysed.
    """
    scene = design.scene
    table: Table | None = scene.values.get(TOLERANCE)
    if table is None:
        message = "is missing: it states the tolerances, see docs/tolerance.md"
        raise _refused(scene, (TOLERANCE,), message)
    machine, second = machines_of(design, table.get("flank"))
    for each in (machine, second):
        if each is not None:
            each.require_whole()
    sides = Sides(scene, machine, second)
    sources = (*_dimensions(sides, table), *_fits(sides, table), *_forms(sides, table))
    limit, set_at = table.get("limit"), table.get("set_at")
    per = math.radians(1.0) if design.drive.unit == "rad" else MM_PER[scene.unit]
    return Stated(
        machine,
        second,
        sources,
        None if limit is None else float(limit) * per,
        None if set_at is None else math.radians(set_at),
    )


def machines_of(design: Design, flank: str | None = None) -> tuple[Machine, Machine | None]:
    """The machine of a design on a flank, by default its main one; and of a follower that two sides
    hold, where the other side carries it.
    """
    cam, *others = design.cams
    if cam.opposite is not None:
        others = [cam.opposite]
    main = Hold.MAIN if others else Hold.ANY
    second = [Machine(each, Flank(each.contact.main), Hold.RETURN) for each in others]
    return Machine(cam, Flank(flank or cam.contact.main), main), second[0] if second else None


@dataclass(frozen=True)
class Sides:
    """The machine of a scene, by the sides that hold its follower."""

    scene: Scene
    machine: Machine
    second: Machine | None

    def hold_of(self, place: Path, table: Table, *, is_disc: bool) -> Hold:
        """The side that a fit or an error of form is on: of a yoke, both sides have one disc."""
        whole = self.second is None or (is_disc and self.second.cam.mount is None)
        if whole and "side" in table:
            what = "has one disc" if self.second is not None else "is held by one side"
            raise _refused(self.scene, (*place, "side"), f"belongs to two: this follower {what}")
        return Hold.ANY if whole else Hold(table.get("side", Hold.MAIN))


def _refused(scene: Scene, path: Path, message: str, hint: str = "") -> SceneError:
    return SceneError([scene.stated.scene.fault(path, message, hint)], scene.source.file)


def _dimensions(sides: Sides, table: Table) -> Iterator[Source]:
    scene, machine = sides.scene, sides.machine
    known = dimensions_of(machine, sides.second)
    for index, each in enumerate(table.get("dimension", ())):
        key, place = each["key"], (TOLERANCE, "dimension", index)
        if key not in known:
            kind = machine.cam.follower.kind
            message = f"is no dimension of this {kind} machine; it has {listed(sorted(known))}"
            raise _refused(scene, (*place, "key"), message, meant(key, known))
        dimension = known[key]
        distribution = _distribution(scene, place, each, dimension)
        yield ToleratedDimension(
            key, dimension.sense, dimension.unit, distribution, dimension.is_angle
        )


def _distribution(scene: Scene, place: Path, table: Table, dimension: Dimension) -> Distribution:
    mm = MM_PER[scene.unit]
    per = math.radians(1.0) if dimension.is_angle else mm
    if "class" in table:
        if dimension.size is None:
            message = "belongs to lengths: this dimension takes plus_minus or limits"
            raise _refused(scene, (*place, "class"), message)
        low, high = (
            each * dimension.per_size
            for each in _class(scene, (*place, "class"), table["class"], dimension.size)
        )
    elif "limits" in table:
        low, high = (float(each) * per for each in table["limits"])
    else:
        high = float(table["plus_minus"]) * per
        low = -high
    shape: Shape = table.get("distribution", "normal")
    sigma = table.get("sigma")
    return Distribution(low, high, shape, None if sigma is None else float(sigma) * per)


def _class(scene: Scene, path: Path, name: str, size: float) -> tuple[float, float]:
    try:
        return limits_of(name, size)
    except GeometryError as error:
        raise _refused(scene, path, error.message) from error


def _fits(sides: Sides, table: Table) -> Iterator[Source]:
    scene, machine = sides.scene, sides.machine
    for index, each in enumerate(table.get("clearance", ())):
        place = (TOLERANCE, "clearance", index)
        size = _size(scene, place, each)
        limits = {}
        for key, hole in (("hole", True), ("shaft", False)):
            if is_hole(each[key]) is not hole:
                letters = "a capital letter" if hole else "a small letter"
                raise _refused(scene, (*place, key), f"must begin with {letters}")
            limits[key] = _class(scene, (*place, key), each[key], size)
        if limits["hole"][0] < limits["shaft"][1]:
            over = PER_MM * (limits["shaft"][1] - limits["hole"][0])
            message = (
                f"is no fit with clearance: {each['hole']}/{each['shaft']} may interfere by"
                f" {over:.4g} micrometres; leave it out, or state a looser fit"
            )
            raise _refused(scene, place, message)
        hold = sides.hold_of(place, each, is_disc=each["at"] == "cam")
        yield _clearance(place, each, hold, machine.flank, limits)


def _size(scene: Scene, place: Path, table: Table) -> float:
    """The nominal diameter [mm]."""
    if "size" in table:
        return float(table["size"]) * MM_PER[scene.unit]
    if scene.part is None or scene.part.bore is None:
        message = "is missing: the scene has no part.bore, whose diameter is the default"
        raise _refused(scene, (*place, "size"), message)
    return scene.part.bore


def _clearance(
    place: Path,
    table: Table,
    hold: Hold,
    flank: Flank,
    limits: Mapping[str, tuple[float, float]],
) -> Source:
    shape: Shape = table.get("distribution", "normal")
    fit = Fit(*(Distribution(*limits[key], shape) for key in ("hole", "shaft")))
    name = f"{spelled(place[1:])} {table['hole']}/{table['shaft']}"
    at_cam = table["at"] == "cam"
    if at_cam and table.get("shifted", "anywhere") == "anywhere":
        return LooseClearance(name, "the cam lies anywhere in its clearance", fit, hold)
    what = "cam" if at_cam else "roller"
    return PressedClearance(name, f"the load pushes the {what} back", fit, hold, flank.sign)


def _forms(sides: Sides, table: Table) -> Iterator[Source]:
    for index, each in enumerate(table.get("form", ())):
        height = float(each["plus_minus"]) * MM_PER[sides.scene.unit]
        waves = int(each["waves"])
        hold = sides.hold_of((TOLERANCE, "form", index), each, is_disc=True)
        yield FormError(f"form[{index + 1}]", f"{waves} waves on the flank", height, waves, hold)
