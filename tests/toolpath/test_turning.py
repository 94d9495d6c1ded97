"""Work turned over: places of the part as they lie on the machine, and back."""

from __future__ import annotations

from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.milling import (
    AXES,
    FIRST_SIDE,
    MIRRORED_SIDE,
    Clamp,
    Stock,
    mirrored,
    mirrored_all,
)
from camgeo.milling.moves import Zero, described
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Layer, Part

LENGTHS = st.floats(-1e3, 1e3)
PLACES = st.builds(complex, LENGTHS, LENGTHS)
TURNED = st.sampled_from((FIRST_SIDE, *AXES))
ROUNDING = 1e-12
"""Of differences of lengths up to 2000 mm."""


@given(PLACES, TURNED)
def test_twice_is_as_before(place: complex, about: str) -> None:
    assert mirrored(mirrored(place, about), about) == place
    assert mirrored_all(np.array([place]), about)[0] == mirrored(place, about)


@given(PLACES, PLACES, TURNED)
def test_lengths_stay_and_senses_change(one: complex, other: complex, about: str) -> None:
    """The area that two arms span keeps its size; where work is turned over, not its sign."""
    a, b = mirrored(one, about), mirrored(other, about)
    assert abs(a) == abs(one)
    area, seen = (one.conjugate() * other).imag, (a.conjugate() * b).imag
    assert seen == (area if about == FIRST_SIDE else -area)


@pytest.mark.parametrize(("about", "stays"), [("x", 1.0), ("y", 1j)])
def test_the_axis_stays(about: str, stays: complex) -> None:
    assert mirrored(stays, about) == stays
    assert mirrored(1j * stays, about) == -1j * stays


@given(PLACES, PLACES, LENGTHS, LENGTHS, TURNED)
def test_a_zero_is_undone(
    place: complex, origin: complex, z: float, height: float, about: str
) -> None:
    zero = Zero("axis", "part-top", origin, height, about)
    assert abs(zero.to_part(zero.to_program(place)) - place) <= ROUNDING
    assert zero.to_program(origin) == 0j
    x, y, low = zero.point_to_program((place.real, place.imag, z))
    assert complex(x, y) == zero.to_program(place)
    assert low == z - height


def test_names_of_sides_change_places() -> None:
    assert all(MIRRORED_SIDE[MIRRORED_SIDE[name]] == name for name in MIRRORED_SIDE)
    assert MIRRORED_SIDE["left"] == "right"


@pytest.mark.parametrize("about", AXES)
def test_a_clamp_stands_where_it_is_stated(about: str) -> None:
    """Its corners, seen in the mirror, are those of the table; its name is as stated."""
    stated = Clamp(place=30.0 + 10.0j, length=20.0, width=8.0, height=9.0, angle=0.3)
    turned = stated.turned_over(about)
    wanted = stated.obstacle.outline.arcs(0.01).contour.vertices
    found = mirrored_all(turned.obstacle.outline.arcs(0.01).contour.vertices, about)
    for corner in wanted:
        assert np.min(np.abs(found - corner)) <= ROUNDING
    assert turned.obstacle.name == stated.obstacle.name == "clamp at 30, 10 mm"


# -- blank -----------------------------------------------------------------------------------------
# The blank of a program, in words and as a box, from any zero.


RIM: Final = ExactBoundary("rim", hole=False, exact=Contour.circle(20.0))

PART: Final = Part((Layer(-8.0, 0.0, (RIM,)), Layer(0.0, 5.0, (RIM,), "hub")))

PLATE: Final = Stock(length=80.0, width=60.0, centre=3 - 2j, top=1.0, bottom=2.0)

CORNER: Final = Zero("front-left", "blank-top", -37 - 32j, 6.0)


@pytest.mark.parametrize(
    ("stock", "zero", "said"),
    [
        (
            PLATE,
            Zero(),
            "plate, 80 x 60 mm, 16 mm high, its upper face at Z 6, its middle at X 3, Y -2",
        ),
        (
            PLATE,
            CORNER,
            "plate, 80 x 60 mm, 16 mm high, its upper face at Z 0, its middle at X 40, Y 30",
        ),
        (
            Stock(shape="round", diameter=50.0, bore=8.0),
            Zero(),
            "round, diameter 50 mm, 13 mm high, bore 8 mm, its upper face at Z 5",
        ),
        (Stock(), Zero(), "plate of unstated size, 13 mm high, its upper face at Z 5"),
    ],
)
def test_it_is_described_from_the_zero(stock: Stock, zero: Zero, said: str) -> None:
    assert described(stock, PART, zero) == said


def test_inches() -> None:
    stock = Stock(shape="round", diameter=50.8)
    said = described(stock, PART, Zero(), "inch")
    assert said == "round, diameter 2 inch, 0.511811 inch high, its upper face at Z 0.19685"
