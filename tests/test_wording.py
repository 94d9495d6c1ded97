"""Counts agree with their nouns, and messages name each cam angle once."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.units import (
    TURN,
    at_cam_angles,
    cam_angle,
    clock,
    counted,
    listed,
    over_cam_angles,
    told_apart,
)

ROOT = Path(__file__).resolve().parents[1]

NOUNS = (
    "angle|arc|byte|cell|column|contour|corner|edge|facet|fault|file|finding|gap|height|jump|kink"
    "|knot|law|line|lobe|loop|pass|piece|point|quantitie|range|row|scene|segment|shock|vertice"
)
COUNT = re.compile(rf"\{{(?![A-Z_]+\b)[^{{}}]*\}} (?:[a-z]+ )?(?:{NOUNS})s\b")
"""A number, other than a constant, before a noun in the plural, in a formatted text."""


def test_nouns_agree_with_their_numbers() -> None:
    assert counted(1, "shock") == "1 shock"
    assert [counted(number, "shock") for number in (0, 2)] == ["0 shocks", "2 shocks"]
    assert counted(1234, "entity", "entities") == "1,234 entities"
    assert counted(1, "entity", "entities") == "1 entity"


def test_words_are_listed_up_to_a_number() -> None:
    assert [listed("abcd"[:number]) for number in (1, 2, 3)] == ["a", "a and b", "a, b and c"]
    assert listed("abcd", 4) == listed("abcd") == "a, b, c and d"
    assert listed("abcd", 2) == "a, b and 2 more"


def test_a_place_is_named_once() -> None:
    quarter = math.radians(90.0)
    assert at_cam_angles(0.0, 0.0) == at_cam_angles(0.0, TURN) == "at cam angle 0 deg"
    assert at_cam_angles(quarter, quarter + 1e-9) == "at cam angle 90 deg"
    assert at_cam_angles(0.0, quarter) == "at cam angles 0 and 90 deg"
    assert at_cam_angles(quarter, form=".4f") == "at cam angle 90.0000 deg"
    assert over_cam_angles(quarter, quarter + 1e-9) == "at cam angle 90 deg"
    assert over_cam_angles(quarter, TURN + 0.5 * quarter) == "from cam angle 90 to 45 deg"
    assert over_cam_angles(0.0, TURN) == "over the whole turn"


@given(st.floats(-50.0, 50.0), st.sampled_from((".4f", ".6g", ".6f")))
def test_a_cam_angle_is_below_a_turn(angle: float, form: str) -> None:
    shown = float(cam_angle(angle, form))
    assert 0.0 <= shown < 360.0
    off = (math.radians(shown) - angle + math.pi) % TURN - math.pi
    assert abs(off) <= math.radians(5.1e-4 if form == ".6g" else 5.1e-5) + 1e-14


@pytest.mark.parametrize("folder", ["camgeo", "export"])
def test_messages_count_with_counted(folder: str) -> None:
    """No text has a plural after a number that may be 1."""
    found = [
        f"{path.relative_to(ROOT)}: {match[0]}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        for match in COUNT.finditer(path.read_text(encoding="utf-8"))
    ]
    assert found == []


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.4, "0 s"), (59.6, "1:00 min"), (187.0, "3:07 min"), (3599.7, "1:00:00 h"),
     (3787.0, "1:03:07 h")],
)  # fmt: skip
def test_times_to_the_second(seconds: float, text: str) -> None:
    assert clock(seconds) == text


@given(st.floats(1e-9, 1e3), st.integers(0, 40))
def test_numbers_that_differ_are_told_apart(one: float, steps: int) -> None:
    """Down to neighbouring floating-point numbers, and no longer than they must be."""
    other = one
    for _ in range(steps):
        other = math.nextafter(other, math.inf)
    less, more = told_apart(one, other)
    assert (float(less) < float(more)) == (one != other)
    assert told_apart(0.005, 0.005000012) == ("0.005", "0.00500001")
    assert told_apart(0.005, 0.0095) == ("0.005", "0.0095")
