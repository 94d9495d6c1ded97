"""Compensation of the cutter's radius: how far offsets may be off, and what is programmed."""

from __future__ import annotations

from typing import Any, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.compensation import (
    LEAD,
    SHARE,
    OffsetLimit,
    offset_limit,
    offset_limits,
    programmed,
)
from camgeo.milling.cut import ContourCut
from camgeo.milling.machine import load
from camgeo.milling.milling import Clamp, Heights, Tool
from camgeo.milling.moves import ArcFeed, Feed, Operation, Stop
from camgeo.milling.strategies import cut_moves
from camgeo.part.boundaries import ExactBoundary
from tests.part.parts import refused

TOOL: Final = Tool(
    number=3, diameter=4.0, spindle_speed=1000.0, feed=100.0, plunge_feed=50.0, stepdown=5.0
)

HEIGHTS: Final = Heights(5.0, 5.0)


def operation(mode: str, room: float = 8.0, radius: float = 30.0, **more: Any) -> Operation:
    """Once round a disc of `radius` [mm]."""
    disc = ExactBoundary("disc", hole=False, exact=Contour.circle(radius))
    cut = ContourCut(
        name="disc", strategy="profile", tool=TOOL, top=0.0, depths=(-2.0,), right="disc",
        centre=disc.offset(TOOL.radius), room=room, cleared=True, compensation=mode,
        **more,
    )  # fmt: skip
    return Operation(cut, tuple(cut_moves(cut, HEIGHTS, 1e-3, "fast")))


def switches(found: Operation) -> list[str]:
    return [move.switch for move in found.moves if isinstance(move, Feed) and move.switch]


@pytest.mark.parametrize(("mode", "climb", "expected"), [
    ("computed", True, []),
    ("wear", True, ["left", "off"]),
    ("wear", False, ["right", "off"]),
    ("control", True, ["left", "off"]),
])  # fmt: skip
def test_the_leads_switch_it(mode: str, climb: bool, expected: list[str]) -> None:
    found = operation(mode, climb=climb)
    assert switches(found) == expected
    assert (offset_limit(found) is None) == (not expected)


@settings(max_examples=20)
@given(st.floats(0.05, 12.0))
def test_the_wear_is_at_most_half_a_lead_and_smaller_than_any_arc(room: float) -> None:
    """Nor is it more than what is cleared beside the path, as where a slot is wider than the cutter
    by its allowance.
    """
    found = operation("wear", room)
    limit = offset_limit(found)
    assert limit is not None
    assert limit.most <= SHARE * room
    at = 0j
    for move in found.travel:
        end = complex(move.end[0], move.end[1])
        if isinstance(move, Feed) and move.switch:
            assert limit.most <= SHARE * abs(end - at) / LEAD
        if isinstance(move, ArcFeed):
            assert limit.most < abs(at - complex(*move.centre))
        at = end


def test_a_clamp_beside_the_path_limits_the_wear() -> None:
    free = offset_limit(operation("wear"))
    gap = 0.2
    clamp = Clamp(place=complex(-30.0 - 4.0 - 1.0 - gap, 0.0), length=2.0, width=2.0, height=3.0)
    near = offset_limit(operation("wear", obstacles=(clamp.obstacle,)))
    assert free is not None
    assert near is not None
    assert near.most <= SHARE * gap < free.most


def test_where_there_is_no_room_it_says_so() -> None:
    with refused("output.gcode.compensation", "leaves no room for it"):
        offset_limit(operation("wear", 0.0005))


def test_control_programs_the_wall() -> None:
    """Between the leads the cutter's edge is on the disc; where it is off nothing is moved."""
    found = operation("control")
    moves = [move for move in programmed(found) if not isinstance(move, Stop)]
    assert [type(move) for move in moves] == [type(move) for move in found.travel]
    places = [complex(move.end[0], move.end[1]) for move in moves]
    radii = [
        abs(place) for place, move in zip(places, moves, strict=True) if isinstance(move, ArcFeed)
    ]
    on_the_wall = [radius for radius in radii if abs(radius - 30.0) < 1e-9]
    assert len(on_the_wall) >= 2
    (on,) = [k for k, move in enumerate(moves) if isinstance(move, Feed) and move.switch == "left"]
    (off,) = [k for k, move in enumerate(moves) if isinstance(move, Feed) and move.switch == "off"]
    for k, (move, centre) in enumerate(zip(moves, found.travel, strict=True)):
        apart = abs(places[k] - complex(centre.end[0], centre.end[1]))
        assert apart == pytest.approx(TOOL.radius if on <= k < off else 0.0, abs=1e-9)
        assert move.end[2] == centre.end[2]
    # The way on is straight on: the controller takes the radius up along it.
    start, end, arc = places[on - 1], places[on], moves[on + 1]
    assert isinstance(arc, ArcFeed)
    along = (end - start) / abs(end - start)
    across = (end - complex(*arc.centre)) / along
    assert across.real == pytest.approx(0.0, abs=1e-9)
    assert across.imag < 0.0
    assert abs(end - start) > 2.0 * TOOL.radius


def test_control_needs_room_for_the_radius() -> None:
    with pytest.raises(GeometryError, match='"wear" needs less'):
        operation("control", 4.0)


def test_one_offset_holds_one_thing() -> None:
    worn, whole = operation("wear"), operation("control")
    with pytest.raises(GeometryError, match="tool 3"):
        offset_limits([worn, whole])
    assert set(offset_limits([worn])) == {"disc"}


@pytest.mark.parametrize("machine", ["linuxcnc", "fanuc", "sinumerik", "heidenhain"])
@pytest.mark.parametrize("mode", ["wear", "control"])
def test_the_sentence_says_what_the_table_holds(machine: str, mode: str) -> None:
    words = load(machine).compensation
    assert words is not None
    said = OffsetLimit("disc", mode, 3, 2.0, 0.25).sentence(words, "{:g} mm".format)
    assert said.endswith("at most 0.25 mm either way")
    if mode == "wear" and not words.nominal:
        assert f"D3 holds {'twice ' if words.table == 'diameter' else ''}the wear alone" in said
    else:
        assert f"{4 if words.table == 'diameter' else 2} mm nominally" in said
