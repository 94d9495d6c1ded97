"""A part upside down."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.part.part import Layer, Part
from tests.part.parts import circle

BOUNDARIES = (
    circle("rim", 50.0), circle("bore", 5.0, hole=True), circle("flank", 30.0), circle("hub", 12.0),
)  # fmt: skip


@st.composite
def parts(draw: st.DrawFn) -> Part:
    """Up to four layers, each with the rim and some of the others."""
    count = draw(st.integers(1, 4))
    steps = draw(st.lists(st.integers(1, 400), min_size=count, max_size=count))
    low = -sum(steps[: draw(st.integers(1, count))])
    layers = []
    for k, step in enumerate(steps):
        chosen = draw(st.sets(st.sampled_from(BOUNDARIES[1:]), max_size=3))
        own = (BOUNDARIES[0], *(each for each in BOUNDARIES[1:] if each in chosen))
        # Eighths of a millimetre are exact.
        layers.append(Layer(low / 8.0, (low + step) / 8.0, own, f"layer {k}"))
        low += step
    return Part(tuple(layers))


@given(parts())
def test_twice_is_as_before_with_its_top_at_0(part: Part) -> None:
    again = part.turned_over().turned_over()
    top = part.layers[-1].z1
    assert [(each.z0, each.z1) for each in again.layers] == [
        (each.z0 - top, each.z1 - top) for each in part.layers
    ]
    assert [each.boundaries for each in again.layers] == [each.boundaries for each in part.layers]


@given(parts())
def test_what_lay_down_lies_up(part: Part) -> None:
    turned = part.turned_over()
    assert turned.layers[-1].z1 == 0.0
    assert turned.thickness == part.thickness
    low = part.layers[0].z0
    walls = {(wall.boundary.name, low - wall.z1, low - wall.z0) for wall in part.walls}
    assert {(wall.boundary.name, wall.z0, wall.z1) for wall in turned.walls} == walls
    assert set(turned.boundaries) == set(part.boundaries)


def test_the_edges_of_a_groove_lie_below() -> None:
    rim, bore, flank, _ = BOUNDARIES
    part = Part((Layer(-9.0, -5.0, (rim, bore)), Layer(-5.0, 0.0, (rim, bore, flank), "groove")))
    walls = {wall.boundary.name: (wall.z0, wall.z1) for wall in part.turned_over().walls}
    assert walls == {
        "rim": (-9.0, 0.0),
        "bore": (-9.0, 0.0),
        "flank": (pytest.approx(-9.0), pytest.approx(-4.0)),
    }
