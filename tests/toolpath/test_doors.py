"""Every value of a milling program is checked where it comes in, with its key."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from typing import Any

import pytest

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.part.boundaries import ExactBoundary
from camgeo.toolpath.cut import MOST_PASSES, Cut, passes
from camgeo.toolpath.machine import load
from camgeo.toolpath.machining_time import Dynamics
from camgeo.toolpath.moves import ArcFeed, Feed, Operation, Rapid, Toolpath
from camgeo.toolpath.spec import GcodeSpec

WRONG: tuple[Any, ...] = (
    0, -5.0, math.nan, math.inf, -math.inf, 5e-324, 1e300, 10**400, "3", True, 1j, [1.0], {},
)  # fmt: skip

SPEC = GcodeSpec(pass_depth=2.0)

BORE = ExactBoundary("bore", hole=True, exact=Contour.circle(5.0))

CUT = Cut("bore", "profile", SPEC.tool, BORE, "bore", "", (-2.0, -4.0), 1.0)

HOME = Rapid((0.0, 0.0, 5.0))

LENGTHS = [field.name for field in fields(GcodeSpec) if field.name != "machine"]


@pytest.mark.parametrize("value", WRONG, ids=repr)
@pytest.mark.parametrize("name", LENGTHS)
def test_values_of_the_scene(name: str, value: Any) -> None:
    with pytest.raises(GeometryError) as caught:
        replace(SPEC, **{name: value})
    assert caught.value.key == f"output.gcode.{name}"
    assert caught.value.value


def test_a_machine_is_named() -> None:
    with pytest.raises(GeometryError) as caught:
        replace(SPEC, machine=3)  # type: ignore[arg-type]
    assert caught.value.key == "output.gcode.machine"


@pytest.mark.parametrize("value", WRONG, ids=repr)
def test_values_of_moves(value: Any) -> None:
    if value == 0 or value in (-5.0, 5e-324):  # a place, but no feed
        Rapid((0.0, value, 0.0))
    else:
        with pytest.raises(GeometryError, match=r"finite number|in magnitude"):
            Rapid((0.0, value, 0.0))
        with pytest.raises(GeometryError, match=r"finite number|in magnitude"):
            ArcFeed((0.0, 0.0, 0.0), (value, 0.0), ccw=True, feed=1.0)
    for make in (
        lambda: Feed((0.0, 0.0, 0.0), value),
        lambda: ArcFeed((0.0, 0.0, 0.0), (0.0, 0.0), ccw=True, feed=value),
    ):
        with pytest.raises(GeometryError) as caught:
            make()
        assert caught.value.key == "toolpath"


def test_places_have_their_coordinates() -> None:
    with pytest.raises(GeometryError, match="must be 3 coordinates"):
        Feed((0.0, 0.0), 1.0)  # type: ignore[arg-type]
    with pytest.raises(GeometryError, match="must be 2 coordinates"):
        ArcFeed((0.0, 0.0, 0.0), 0j, ccw=True, feed=1.0)  # type: ignore[arg-type]
    with pytest.raises(GeometryError, match="true or false"):
        ArcFeed((0.0, 0.0, 0.0), (0.0, 0.0), ccw=1, feed=1.0)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "change",
    [
        {"name": 3},
        {"tool": 6.0},
        {"right": None},
        {"depths": ()},
        {"depths": (-4.0, -2.0)},
        {"depths": (-2.0, math.nan)},
        {"depths": "deep"},
        {"room": -1.0},
        {"room": math.inf},
    ],
)
def test_cuts(change: dict[str, Any]) -> None:
    with pytest.raises(GeometryError) as caught:
        replace(CUT, **change)
    assert caught.value.key == "toolpath"


def test_operations_begin_above_the_part_and_have_names_of_their_own() -> None:
    with pytest.raises(GeometryError, match="must begin with a traverse"):
        Operation(CUT, ())
    with pytest.raises(GeometryError, match="must begin with a traverse"):
        Operation(CUT, (Feed((0.0, 0.0, -1.0), 100.0), HOME))
    operation = Operation(CUT, (HOME,))
    with pytest.raises(GeometryError, match="a name of its own"):
        Toolpath(5.0, (operation, operation))
    with pytest.raises(GeometryError) as caught:
        Toolpath(math.nan, (operation,))
    assert caught.value.key == "output.gcode.safe_height"


def test_no_more_passes_than_sense() -> None:
    assert len(passes(0.0, -10.0, 10.0 / MOST_PASSES)) == MOST_PASSES
    with pytest.raises(GeometryError, match=r"must be at least 0\.001 mm") as caught:
        passes(0.0, -10.0, 1e-9)
    assert caught.value.key == "output.gcode.pass_depth"


@pytest.mark.parametrize("value", WRONG, ids=repr)
def test_values_of_machines(value: Any) -> None:
    machine = load("linuxcnc")
    for make, key in (
        (lambda: replace(machine.arcs, largest_sweep=value), "arcs.largest_sweep"),
        (lambda: Dynamics(value, 1.0), "dynamics.acceleration"),
        (lambda: replace(machine.comment, line_length=value), "comment.line_length"),
        (lambda: replace(machine, end=value), "end"),
        (lambda: replace(machine, name=value), "name"),
        (lambda: replace(machine, dynamics=value), "dynamics"),
    ):
        if key == "name" and value == "3":  # which is a name
            continue
        with pytest.raises(GeometryError) as caught:
            make()
        assert caught.value.key == key
