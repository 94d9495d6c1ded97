"""Texts of dimensions beside what they measure."""

from __future__ import annotations

import cmath
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.pictures.sheet.marks import Chain, Distance, line
from camgeo.pictures.sheet.placing import boxes, cleared, number_of, placed

BOX = boxes([(10 + 0j, 1.0 + 0j, 6.0, 2.0)])


def test_lines_are_interrupted_at_texts_and_nothing_else_is() -> None:
    found = list(cleared([line(0j, 20 + 0j, "CENTRE")], [BOX], ("CENTRE",), 1.0))
    ends = [[complex(end) for end in each.vertices] for each in found if isinstance(each, Chain)]
    assert ends == [[0j, pytest.approx(7)], [pytest.approx(13), 20 + 0j]]
    away = line(5j, 20 + 5j, "CENTRE")
    outline = line(0j, 20 + 0j, "OUTLINE")
    assert list(cleared([away, outline], [BOX], ("CENTRE",), 1.0)) == [away, outline]


@given(
    size=st.floats(0.1, 500.0), turn=st.floats(-7.0, 7.0), scale=st.sampled_from([0.1, 1.0, 10.0])
)
def test_placing_changes_no_measure_and_keeps_texts_upright(
    size: float, turn: float, scale: float
) -> None:
    along = cmath.rect(1.0, turn)
    mark = Distance(3 + 4j, 3 + 4j + size * along, 5 + 5j, turn)
    for price, (first, *rest) in placed(mark, scale, "mm", along):
        assert isinstance(first, Distance)
        assert first.measure == pytest.approx(size, rel=1e-9)
        assert -0.5 * math.pi < first.angle <= 0.5 * math.pi + 1e-9
        assert {first.first, first.second} == {mark.first, mark.second}
        assert bool(first.aside) == bool(rest)
        assert price >= 0.0


@pytest.mark.parametrize(
    ("size", "unit", "decimals", "text"),
    [(16.0, "mm", 4, "16"), (18.30000001, "mm", 3, "18.3"), (100.0, "mm", 0, "100"),
     (4.7625, "inch", 5, "0.1875"), (1200.0, "mm", 2, "1200")],
)  # fmt: skip
def test_numbers_have_no_zeros_at_their_end(
    size: float, unit: str, decimals: int, text: str
) -> None:
    mark = Distance(0j, size + 0j, 0j, prefix="%%c", suffix=" H7", decimals=decimals)
    assert number_of(mark, "inch" if unit == "inch" else "mm") == f"%%c{text} H7"
