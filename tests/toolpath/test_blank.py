"""The blank of a program, in words and as a box, from any zero."""

from __future__ import annotations

from typing import Final

import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.milling import Stock
from camgeo.milling.zero import OF_THE_PART, Zero, box, described
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Layer, Part

RIM: Final = ExactBoundary("rim", hole=False, exact=Contour.circle(20.0))

PART: Final = Part((Layer(-8.0, 0.0, (RIM,)), Layer(0.0, 5.0, (RIM,), "hub")))

PLATE: Final = Stock(length=80.0, width=60.0, centre=3 - 2j, top=1.0, bottom=2.0)

CORNER: Final = Zero("front-left", "blank-top", -37 - 32j, 6.0)


@pytest.mark.parametrize(
    ("stock", "zero", "expected"),
    [
        (PLATE, OF_THE_PART, ((-37.0, -32.0, -10.0), (43.0, 28.0, 6.0))),
        (PLATE, CORNER, ((0.0, 0.0, -16.0), (80.0, 60.0, 0.0))),
        (
            Stock(shape="round", diameter=50.0, centre=1j),
            OF_THE_PART,
            ((-25.0, -24.0, -8.0), (25.0, 26.0, 5.0)),
        ),
        (Stock(), OF_THE_PART, None),
    ],
)
def test_the_box_is_around_the_blank(stock: Stock, zero: Zero, expected: object) -> None:
    assert box(stock, PART, zero) == expected


@pytest.mark.parametrize(
    ("stock", "zero", "said"),
    [
        (
            PLATE,
            OF_THE_PART,
            "plate, 80 x 60 mm, 16 mm high, its upper face at Z 6, its middle at X 3, Y -2",
        ),
        (
            PLATE,
            CORNER,
            "plate, 80 x 60 mm, 16 mm high, its upper face at Z 0, its middle at X 40, Y 30",
        ),
        (
            Stock(shape="round", diameter=50.0, bore=8.0),
            OF_THE_PART,
            "round, diameter 50 mm, 13 mm high, bore 8 mm, its upper face at Z 5",
        ),
        (Stock(), OF_THE_PART, "plate of unstated size, 13 mm high, its upper face at Z 5"),
    ],
)
def test_it_is_described_from_the_zero(stock: Stock, zero: Zero, said: str) -> None:
    assert described(stock, PART, zero) == said


def test_inches() -> None:
    stock = Stock(shape="round", diameter=50.8)
    said = described(stock, PART, OF_THE_PART, "inch")
    assert said == "round, diameter 2 inch, 0.511811 inch high, its upper face at Z 0.19685"
