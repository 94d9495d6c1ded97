"""Holding: what cuts something free is held, clamps come and go, and nothing runs into them."""

from __future__ import annotations

import math
from typing import Any

import pytest

from camgeo.cam.cam import Contact
from camgeo.geometry.contour.contour import POINTS
from camgeo.milling.cut import ContourCut
from camgeo.milling.holding import Clamp, Holding, Tabs
from camgeo.milling.milling import Stock
from camgeo.milling.planned import LARGEST
from camgeo.milling.simulation import FINENESS
from tests.toolpath.milled import BORE, RIM, THICKNESS, named, sequence, tool

INNER, OUTER, GROOVE = Contact.INNER, Contact.OUTER, Contact.GROOVE

WASHER = Clamp(place=0j, length=30.0, width=30.0, height=8.0, round=True, since="rough outline")


ASIDE = Clamp(place=100.0 + 0j, length=20.0, width=20.0, height=8.0)

ON_IT = Clamp(place=20.0j, length=8.0, width=8.0, height=8.0, since="rough outline")


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


@pytest.mark.parametrize(
    ("contact", "given"),
    [
        (GROOVE, {"stock": Stock(bore=BORE), "holding": None}),  # cut into the blank
        (GROOVE, {"stock": Stock(shape="round", diameter=RIM, bore=BORE), "holding": None}),
        (INNER, {"stock": Stock(length=170.0, width=170.0, bore=BORE)}),
        (INNER, {"holding": Holding(kind="clamps", through=0.5, clamps=(ASIDE, ON_IT))}),
    ],
)
def test_what_may_just_be(contact: Contact, given: dict[str, Any]) -> None:
    """`test_refused.py` has what may not."""
    assert sequence(contact, **given).cuts


def test_chords_of_the_largest_work_can_be_simulated() -> None:
    assert math.pi / math.acos(1.0 - FINENESS / LARGEST) < 25_000 < POINTS


def test_a_core_that_a_fixture_must_hold_is_told() -> None:
    (told,) = (each for each in sequence(OUTER).findings if each.name == "loose-core")
    assert told.severity == "warning"
