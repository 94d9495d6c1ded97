"""Holding: what cuts something free is held, clamps come and go, and nothing runs into them."""

from __future__ import annotations

import math

import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import POINTS
from camgeo.milling.cut import ContourCut
from camgeo.milling.guard import LARGEST
from camgeo.milling.holding import Clamp, Holding, Tabs
from camgeo.milling.milling import Stock
from camgeo.milling.moves import Heights
from camgeo.milling.simulation import FINENESS
from tests.toolpath.milled import BORE, RIM, THICKNESS, named, sequence, tool

INNER, OUTER, GROOVE = Contact.INNER, Contact.OUTER, Contact.GROOVE

WASHER = Clamp(place=0j, length=30.0, width=30.0, height=8.0, round=True, since="rough outline")


def test_a_cut_through_the_blank_needs_a_holding() -> None:
    for contact in (INNER, OUTER, GROOVE):
        with pytest.raises(GeometryError, match="goes through, and what it cuts free drops") as it:
            sequence(contact, holding=None)
        assert it.value.key == "holding"
    # A groove alone is cut into the blank.
    sequence(GROOVE, holding=None, stock=Stock(bore=25.0))


def test_a_skin_is_left_below_the_part_and_told() -> None:
    found = sequence(INNER, holding=Holding(kind="onion-skin", skin=0.3))
    assert {cut.bottom for cut in found.cuts} == {0.3 - THICKNESS}
    assert [each.severity for each in found.findings if each.name == "onion-skin"] == ["warning"]


def test_tabs_stand_on_what_is_cut_free_and_are_told_on_a_flank() -> None:
    holding = Holding(kind="tabs", through=0.5, tabs=Tabs(4, 6.0, 2.0))
    found = sequence(INNER, holding=holding)
    tabs = {cut.name: cut.tabs is not None for cut in found.cuts if isinstance(cut, ContourCut)}
    assert tabs == {"rough bore": False, "bore": False, "rough outline": True, "outline": True}
    (told,) = (each for each in found.findings if each.name == "tabs-on-a-flank")
    assert told.severity == "warning"
    assert "4 tabs of 6 mm, up to 2 mm" in told.sentence
    stock = Stock(length=170.0, width=170.0, bore=25.0)
    rim = sequence(GROOVE, tool(12.0), stock=stock, holding=holding)
    assert not any(each.name == "tabs-on-a-flank" for each in rim.findings)
    cut = named(rim)["rim"]
    assert isinstance(cut, ContourCut)
    # The cut ends below the part; tabs are stated from its lower face.
    assert cut.tabs == Tabs(4, 6.0, 2.5)


def test_a_screw_is_set_when_the_bore_is_there() -> None:
    holding = Holding(kind="screws", through=0.5, clamps=(WASHER,))
    found = named(sequence(INNER, holding=holding))
    assert [len(cut.obstacles) for cut in found.values()] == [0, 0, 1, 1]
    assert found["rough outline"].stop == "set the screw at 0, 0 mm"
    assert found["outline"].stop == ""
    early = Clamp(place=0j, length=30.0, width=30.0, height=8.0, round=True)
    with pytest.raises(GeometryError, match=r"rough bore .*runs into the screw at 0, 0 mm"):
        sequence(INNER, holding=Holding(kind="screws", through=0.5, clamps=(early,)))


def test_what_is_cut_free_is_held_by_something_that_stands_on_it() -> None:
    aside = Clamp(place=100.0 + 0j, length=20.0, width=20.0, height=8.0)
    with pytest.raises(GeometryError, match="free while nothing that is set stands on it"):
        sequence(INNER, holding=Holding(kind="clamps", through=0.5, clamps=(aside,)))
    on_it = Clamp(place=20.0j, length=8.0, width=8.0, height=8.0, since="rough outline")
    sequence(INNER, holding=Holding(kind="clamps", through=0.5, clamps=(aside, on_it)))


def test_cutters_and_traverses_clear_the_clamps() -> None:
    over_the_edge = Clamp(place=50.0j, length=20.0, width=60.0, height=8.0)
    with pytest.raises(GeometryError, match="rough outline with tool 1 runs into the clamp"):
        sequence(INNER, holding=Holding(kind="clamps", through=0.5, clamps=(over_the_edge,)))
    holding = Holding(kind="screws", through=0.5, clamps=(WASHER,))
    with pytest.raises(GeometryError, match=r"above the screw at 0, 0 mm, 8 mm high") as caught:
        sequence(INNER, holding=holding, heights=Heights.of(8.0))
    assert caught.value.key == "output.gcode.clearance_height"
    stock = Stock(shape="round", diameter=160.0, top=5.0)
    with pytest.raises(GeometryError, match="above the blank, 5 mm") as caught:
        sequence(INNER, stock=stock, heights=Heights(20.0, 4.0))
    assert caught.value.key == "output.gcode.retract_height"


def test_a_clamp_names_operations_that_there_are() -> None:
    wrong = Clamp(place=0j, length=30.0, width=30.0, height=8.0, until="outlin")
    with pytest.raises(GeometryError, match='no such operation; there are "rough bore"') as caught:
        sequence(INNER, holding=Holding(kind="clamps", through=0.5, clamps=(wrong,)))
    assert caught.value.key == "holding.clamp.until"


def test_a_core_that_a_fixture_must_hold_is_told() -> None:
    (told,) = (each for each in sequence(OUTER).findings if each.name == "loose-core")
    assert told.severity == "warning"


@pytest.mark.parametrize(
    ("holding", "key"),
    [
        (Holding(kind="onion-skin", skin=THICKNESS), "holding.thickness"),
        (Holding(kind="tabs", through=0.5, tabs=Tabs(4, 6.0, THICKNESS)), "holding.height"),
    ],
)
def test_what_is_left_to_hold_the_part_is_lower_than_it(holding: Holding, key: str) -> None:
    with pytest.raises(GeometryError, match="must be less than the thickness") as caught:
        sequence(INNER, holding=holding)
    assert caught.value.key == key


@pytest.mark.parametrize(
    "stock",
    [
        Stock(shape="round", diameter=130.0, centre=20.0),
        Stock(length=200.0, width=90.0),
        Stock(length=130.0, width=200.0, centre=20.0 + 3.0j),
    ],
)
def test_the_blank_contains_the_part(stock: Stock) -> None:
    """A part out of a plate is no smaller than one from the round, whatever is cut around it."""
    with pytest.raises(GeometryError, match="the blank is too small") as caught:
        sequence(INNER, stock=stock)
    assert caught.value.key == "stock"
    found = sequence(GROOVE, stock=Stock(shape="round", diameter=RIM, bore=BORE), holding=None)
    assert found.cuts


def test_nothing_is_larger_than_what_is_simulated() -> None:
    """Chords within the fineness of the simulation are no more than it can follow."""
    far = Stock(length=2.0 * LARGEST, width=170.0, bore=25.0)
    with pytest.raises(
        GeometryError, match=r"the blank reaches 1e\+05 mm .* for up to 100000"
    ) as it:
        sequence(GROOVE, stock=far)
    assert it.value.key == "stock"
    with pytest.raises(GeometryError, match="must be at most 200000 mm") as it:
        sequence(INNER, tool(2.1 * LARGEST))
    assert it.value.key == "tool.diameter"
    assert math.pi / math.acos(1.0 - FINENESS / LARGEST) < 25_000 < POINTS


def test_the_hole_of_the_blank_leaves_the_part() -> None:
    sequence(INNER, stock=Stock(length=170.0, width=170.0, bore=BORE))
    with pytest.raises(GeometryError, match=f"at most the bore of the part, {BORE:g} mm") as it:
        sequence(INNER, stock=Stock(length=170.0, width=170.0, bore=BORE + 1e-3))
    assert it.value.key == "stock.bore"
