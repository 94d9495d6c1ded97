"""Every class of the engine that takes numbers refuses other values on entry."""

from __future__ import annotations

import importlib
import inspect
import math
import pkgutil
import sys
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import Field, fields, is_dataclass, replace
from decimal import Decimal
from functools import partial
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest

import camgeo
from camgeo.cam.cam import Yoke
from camgeo.check.finding import Limits
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import (
    OscillatingRoller,
    TranslatingRoller,
    return_on_carriage,
    return_on_lever,
)
from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, SlottedLever
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.milling.cut import AreaCut, ContourCut, PointCut
from camgeo.milling.machine import load
from camgeo.milling.milling import (
    Clamp,
    GcodeSpec,
    Heights,
    Holding,
    MillingSpec,
    OperationSpec,
    Stock,
    Tabs,
    Tool,
)
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Stop, Toolpath
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Layer, Part, Wall
from camgeo.part.spec import Keyway, PartSpec
from camgeo.scene.formats.dxf import DxfSpec
from tests.long_form import examples
from tests.reference import POLYNOMIAL

ROOMS = ("kinematics.mechanism", "geometry")

HOLDERS = {"LeverTable", "LinkedMotions"}
"""Classes that hold what was computed, or is checked before."""

RISE = MotionPlan((Move(Decimal(180), 5.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))
ROLLER = TranslatingRoller(40.0, 10.0, offset=5.0)
ROCKER = OscillatingRoller(100.0 + 0j, 80.0, 60.0, 10.0)
CRANK = SliderCrank(50.0, 120.0, 0.2, True, 1, 1, 1)
PITCH = PitchCurve(RISE, ROLLER, 1)
FLANK = CurveBoundary("outline", hole=False, path=whole(WorkingCurve(PITCH, -10.0)))
BORE = ExactBoundary("bore", hole=True, exact=Contour.circle(10.0))
LAYER = Layer(-5.0, 0.0, (FLANK, BORE))
TOOL = Tool(
    number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0, corner_radius=0.5,
    tip_angle=2.0, flutes=3, flute_length=20.0, stick_out=30.0, shank_diameter=6.0, stepdown=2.0,
    stepover=1.0, engagement=1.0, ramp_angle=0.1,
)  # fmt: skip
CUT = ContourCut(
    name="bore", strategy="profile", tool=TOOL, top=1.0, depths=(-1.0, -2.0), centre=BORE,
    right="bore", room=1.0,
)  # fmt: skip
AREA = AreaCut(
    name="bore", strategy="bore", tool=TOOL, top=1.0, depths=(-1.0, -2.0), walls=(BORE,),
    stepover=1.0,
)  # fmt: skip
HOLES = PointCut(
    name="holes", strategy="drill", tool=TOOL, top=1.0, depths=(-1.0,), points=(1.0 + 2.0j,)
)
TABS = Tabs(4, 5.0, 1.0)
CLAMP = Clamp(place=40.0 + 0j, length=20.0, width=10.0, height=15.0, angle=0.5)
HOME = Rapid((0.0, 0.0, 5.0))
MACHINE = load("linuxcnc")


def is_table(name: str) -> bool:
    """Whether a field of a machine is one of its tables."""
    return is_dataclass(getattr(MACHINE, name))


EXAMPLES: tuple[Any, ...] = (
    ROLLER,
    ROCKER,
    TranslatingFlat(40.0, face=(-10.0, 10.0)),
    OscillatingFlat(100.0 + 0j, 60.0, 1.0, face=(10.0, 90.0)),
    Yoke(80.0),
    CRANK,
    SliderDrivenCrank(CRANK),
    FourBar(40.0, 90.0, 80.0, 100.0 + 0j, 2.0, 1, 1),
    LinkedMotion(RISE, CRANK),
    SlottedLever(10.0, 20.0),
    DrivenLever(SlottedLever(10.0, 20.0), 5.0),
    PITCH,
    WorkingCurve(PITCH, -10.0),
    Keyway(6.0, 3.0, 0.5),
    PartSpec(10.0, 20.0, Keyway(6.0, 3.0), 200.0, 5.0),
    Limits(1.0),
    GcodeSpec(retract_height=2.0),
    OperationSpec(kind="finish", tool=1, boundary="outline"),
    MillingSpec(tools=(TOOL,), stock=Stock()),
    DxfSpec(),
    FLANK,
    BORE,
    LAYER,
    Wall(BORE, -5.0, 0.0),
    Part((LAYER,)),
    TOOL,
    CUT,
    AREA,
    HOLES,
    Stock(shape="round", diameter=100.0),
    Stock(length=100.0, width=100.0),
    TABS,
    CLAMP,
    CLAMP.obstacle,
    Holding(kind="tabs", through=0.5, tabs=TABS),
    Holding(kind="onion-skin", skin=0.3),
    Heights(5.0, 2.0),
    HOME,
    Stop("move the clamp"),
    Feed((0.0, 0.0, -1.0), 100.0),
    ArcFeed((0.0, 0.0, -1.0), (5.0, 0.0), ccw=True, feed=100.0),
    Operation(CUT, (HOME,)),
    Toolpath(Heights(5.0, 5.0), (Operation(CUT, (HOME,)),)),
    MACHINE,
    *(getattr(MACHINE, each.name) for each in fields(MACHINE) if is_table(each.name)),
    MACHINE.numbers.decimals,
    load("fanuc").numbers.increment,
    MACHINE.evidence[0],
)
"""One valid object of each class."""

SIGNED = {
    "offset", "face_offset", "guide_angle", "deflection", "lever_angle", "angle", "distance",
    "z0", "z1", "top",
}  # fmt: skip
"""Numbers that may be negative; all others are above 0, or 0 as the radius of a knife edge."""

NOT_NEGATIVE = {
    "room", "allowance", "rest", "slack", "smallest_radius", "largest_radius", "radius_tolerance",
    "interpolation", "share", "smallest", "largest", "spin_up", "junction_deviation",
    "velocity_jump", "block_time", "short_radius",
}  # fmt: skip
"""Numbers that may be as near to 0 as doubles are."""

ANGLES = {"guide_angle", "deflection", "lever_angle", "angle", "transmission_angle"}

ANY_SIZE = {"SlottedLever", "DrivenLever"}
"""Quantities computed from ratios alone: lengths may be as large or small as doubles can be."""

NEVER: tuple[Any, ...] = (
    math.nan, -math.nan, math.inf, -math.inf, 1e308, -1e308, 10**400, np.float64("nan"), 3.0 + 4.0j,
    "5", "", b"5", True, False, [1.0], (1.0,), {}, object, np.array([1.0, 2.0]), Decimal("NaN"),
    complex(math.nan, 0.0), complex(0.0, math.inf), complex(1e308, 0.0), int, len,
)  # fmt: skip
"""Values that are not a number, point, sense, text or part of a mechanism, unless `allowed`."""

SMALL = (-1.0, -5, -1e-3, -5e-324, 5e-324, 2.2250738585072014e-308, 1e-300, 1e-31, -1e30)
"""Values that are not a length above 0."""

MOST_CALLS = 3000
"""Calls of functions in which a value is refused."""

MOST_BYTES = 100_000

Refusal = tuple[str, Callable[[], object]]


def allowed(annotation: str, value: Any) -> bool:
    """Whether `value` is of what the annotation names: not of interest here."""
    if isinstance(value, str):
        return annotation == "str"
    if isinstance(value, tuple):
        return annotation in ("tuple[float, ...]", "tuple[complex, ...]")
    if isinstance(value, bool):
        return annotation == "bool"
    if isinstance(value, complex):
        finite = math.isfinite(abs(value)) and abs(value) < 1e300
        return annotation.removesuffix(" | NoneType") == "complex" and finite
    return False


def plain_type(example: object, each: Field[Any]) -> str:
    """The annotation of a field without the check that it may name."""
    try:
        hint = get_type_hints(type(example))[each.name]
    except NameError:  # a name for type checkers alone, in a class without such checks
        return str(each.type)
    kinds = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    return " | ".join(kind.__name__ if isinstance(kind, type) else str(kind) for kind in kinds)


def refusals() -> Iterator[Refusal]:
    """A name, and a call that has to be refused, for every field that is given to an example."""
    for example in EXAMPLES:
        for each in (field for field in fields(example) if field.init):
            for value in bad_values(each.name, plain_type(example, each), type(example).__name__):
                name = f"{type(example).__name__}.{each.name}={value!r:.30}"
                yield name, partial(replace, example, **{each.name: value})
    builders: tuple[tuple[Callable[..., object], object, dict[str, float]], ...] = (
        (return_on_carriage, ROLLER, {"spacing": 90.0, "offset": 1.0, "roller_radius": 9.0}),
        (return_on_lever, ROCKER, {"arm_angle": 1.4, "arm": 70.0, "roller_radius": 9.0}),
    )
    for function, main, valid in builders:
        for key in valid:
            values = [*NEVER] if key == "offset" else [*NEVER, *SMALL]
            values = [90.0, *NEVER] if key == "arm_angle" else values
            for value in values:
                given: dict[str, Any] = {**valid, key: value}
                name = f"{function.__name__}({key}={value!r:.30})"
                yield name, partial(function, main, **given)


def bad_values(name: str, annotation: str, owner: str) -> list[Any]:
    values = [value for value in NEVER if not allowed(annotation, value)]
    if "None" not in annotation:
        values.append(None)
    signed = name in SIGNED and not (name == "distance" and owner == "SlottedLever")
    if owner in ANY_SIZE:
        return [value for value in values if not (type(value) is float and 0.0 < value < math.inf)]
    if annotation.startswith("float") and not signed:
        values += [value for value in SMALL if name not in NOT_NEGATIVE or value < 0.0]
    if annotation.startswith("int"):
        values += [] if name == "springs" else [0]
        values += [-2, 0.5] if name == "largest_number" else [-2, 0.5, 100_000]
    if name in ANGLES:
        values += [90.0, -90.0, 1e30]
    return values


REFUSALS = list(refusals())

DOORS: dict[str, list[Refusal]] = {}
"""The refusals by the field, or by the argument, that they are of."""
for _refusal in REFUSALS:
    DOORS.setdefault(_refusal[0].partition("=")[0], []).append(_refusal)


def bounded(call: Callable[[], object]) -> None:
    """Make the call; fail as soon as it needs more work than refusing takes."""
    calls = 0

    def count(*_: object) -> None:
        nonlocal calls
        calls += 1
        assert calls < MOST_CALLS

    tracemalloc.start()
    sys.setprofile(count)
    try:
        call()
    finally:
        sys.setprofile(None)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < MOST_BYTES


def answer(call: Callable[[], object], *, bound: bool = True) -> str:
    """Fault of the refusal of a value; empty if there is none. `bound` to a few calls and bytes."""
    if not bound:
        return _answer(call)
    call = partial(bounded, call)
    found = _answer(call)
    # What is measured is the memory of all threads, of which pytest-xdist has one of its own.
    return _answer(call) if found.startswith("AssertionError") else found


def _answer(call: Callable[[], object]) -> str:
    try:
        call()
    except GeometryError as error:
        return "" if error.key and error.message else f"no key or message: {error!r}"
    except Exception as error:  # reported with the value's name
        return repr(error)
    return "accepted"


@pytest.mark.parametrize("door", DOORS)
def test_what_is_no_value_is_refused_with_its_key(door: str) -> None:
    step = examples(4, long=1)  # calls and bytes are counted of every fourth value
    answers = {
        name: answer(call, bound=number % step == len(door) % step)
        for number, (name, call) in enumerate(DOORS[door])
    }
    assert answers
    assert {name: stated for name, stated in answers.items() if stated} == {}


def test_degrees_are_distinguished_from_radians() -> None:
    with pytest.raises(GeometryError, match="radians") as caught:
        TranslatingRoller(40.0, 10.0, guide_angle=90.0)
    assert caught.value.key == "follower.guide_angle"
    assert caught.value.value == "90.0"


def test_what_is_kept_is_the_number_that_was_given() -> None:
    roller = TranslatingRoller(40, np.float64(10.0), guide_angle=1)
    assert roller == TranslatingRoller(40.0, 10.0, guide_angle=1.0)
    assert [type(each) for each in (roller.base_radius, roller.roller_radius)] == [float, float]


def test_every_class_with_values_of_its_own_is_tried() -> None:
    found: set[Any] = set()
    for room in ROOMS:
        package = importlib.import_module(f"camgeo.{room}")
        for info in pkgutil.walk_packages(package.__path__, f"camgeo.{room}."):
            if info.name.startswith(("camgeo.geometry.outline", "camgeo.geometry.contour")):
                continue
            module = importlib.import_module(info.name)
            found |= {
                each
                for each in vars(module).values()
                if inspect.isclass(each) and each.__module__ == info.name
                if is_dataclass(each) and hasattr(each, "__post_init__")
            }
    public: list[Any] = [getattr(camgeo, name) for name in camgeo.__all__ if name != "Finding"]
    found |= {
        each
        for each in public
        if is_dataclass(each)
        and each.__module__.startswith(tuple(f"camgeo.{room}." for room in ROOMS))
    }
    tried = {type(example) for example in EXAMPLES}
    assert {each.__name__ for each in found - tried} <= HOLDERS
