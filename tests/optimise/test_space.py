"""Designs as places in a box."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.studies.optimise.optimise import Space
from camgeo.studies.sweep.family import Sample, family_of, parse
from tests.findings import known
from tests.sweep.families import SETZHUB


def space(*texts: str) -> Space:
    return Space(tuple(parse(text) for text in texts))


def test_numbers_lists_and_tied_keys_have_places() -> None:
    found = space("a,b=30:60", "c=1:5:5", "d=x,y")
    assert found.continuous.tolist() == [True, False, False]
    assert found.upper.tolist() == [1.0, 4.0, 1.0]
    assert found.count is None
    assert found.point(np.array([0.5, 3.0, 1.0])) == (45, 45, 4, "y")
    assert found.point(np.array([-0.1, 9.0, 0.4])) == (30, 30, 5, "x")
    whole = space("c=1:5:5", "d=x,y")
    assert whole.count == 10
    assert len({whole.point(place) for place in whole.everything()}) == 10


@given(st.floats(0.0, 1.0), st.sampled_from(["30:60", "60:30", "-1:1", "1e-3:2e3", "0:0.1"]))
def test_short_numbers_are_near_and_in_the_range(share: float, text: str) -> None:
    """To 10^-6 of the value or 10^-9 of the range, whichever is more."""
    found = space(f"a={text}")
    low, high = sorted(float(each) for each in text.split(":"))
    (exact,) = found.point(np.array([share]))
    assert isinstance(exact, int | float)
    for (each,) in found.rounded(np.array([share])):
        assert isinstance(each, int | float)
        assert low <= each <= high
        assert abs(each - exact) <= max(1e-6 * abs(exact), 1e-9 * (high - low)) * (1.0 + 1e-9)
        assert len(f"{abs(each):.15g}".replace(".", "").lstrip("0").split("e")[0]) <= 10


def test_numbers_are_rounded_both_ways_in_all_combinations() -> None:
    found = list(space("a=0:3", "b,c=0:3").rounded(np.array([1.0 / 9.0, 2.0 / 9.0])))
    assert found[0] == (0.3333333, 0.6666667, 0.6666667)
    assert len(set(found)) == 4
    many = space(*(f"k{number}=0:3" for number in range(7)))
    assert len(list(many.rounded(np.full(7, 0.123456789)))) == 8


@pytest.mark.parametrize(
    ("vary", "place"),
    [
        (["follower.base_radius=40:60"], [0.50995]),
        (["follower.base_radius=60:40"], [0.49005]),
        (["motion.2.law=modified-sine,polynomial-345", "cam.speed=80:100:3"], [1.0, 1.0]),
        (["follower.base_radius=20:30"], None),
        (["motion.2.law=modified-sine,cycloidal"], None),
        (["limits.diameter=20:30"], None),
        (["follower.arm,follower.base_radius=20:80"], None),
    ],
)
def test_where_the_scene_lies(vary: list[str], place: list[float] | None) -> None:
    family = family_of(SETZHUB, vary, Sample(1))
    found = Space(family.variables).scene_place(family.scene)
    if place is None:
        assert found is None
    else:
        assert known(found) == pytest.approx(place, rel=1e-12)
