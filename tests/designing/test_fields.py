"""Fields of a form: ranges of sliders, and values for JSON."""

from __future__ import annotations

import json
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing.form import Fields, plain, slider_range
from camgeo.scene.keys import parse_path
from camgeo.scene.values import Document

LIMITS = st.one_of(st.none(), st.sampled_from([-1e9, -360.0, -90.0, 0.0, 1e-9]))


@given(value=st.floats(-1e9, 1e9), low=LIMITS, high=st.sampled_from([None, 1.0, 90.0, 360.0, 1e9]))
def test_a_slider_is_within_the_limits_and_about_the_value(
    value: float, low: float | None, high: float | None
) -> None:
    found = slider_range(value, low, high)
    if found is None:
        outside = (low is not None and value < low) or (high is not None and value > high)
        assert outside or abs(value) < 1.0
        return
    start, end, step = found
    assert start <= value <= end
    assert 0.0 < step <= (end - start) / 100
    assert low is None or start >= low
    assert high is None or end <= high


def test_a_slider_stays_the_same_while_it_is_moved_a_little() -> None:
    assert len({slider_range(value, 1e-9, 1e9) for value in (41.0, 50.0, 60.0, 79.0)}) == 1


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("follower.base_radius", "inch"), ("cam.speed", "rev/min"),
        ("follower.guide_angle", "°"), ("follower.face", "inch"), ("motion[1].to", "inch"),
        ("motion[1].velocity", "inch/rad"), ("motion[1].span", "°"), ("part.density", "kg/m³"),
        ("effects.spring.stiffness", "N/mm"), ("limits.radius_ratio", ""), ("name", ""),
        ("no.such.key", ""), ("motion[9].to", "inch"), ("", ""), ("output.tolerance", "inch"),
    ],
)  # fmt: skip
def test_units_are_those_of_the_scene(key: str, unit: str) -> None:
    values: dict[str, Any] = {
        "units": {"length": "inch"},
        "follower": {"kind": "translating-flat" if "face" in key else "translating-roller"},
        "effects": {"spring": {}},
        "motion": [{"law": "auto", "span": 360, "to": 1}],
    }
    assert Fields(Document.from_values(values)).unit(parse_path(key) or ()) == unit


def test_positions_of_a_rocker_are_angles() -> None:
    values = {"follower": {"kind": "oscillating-roller"}, "motion": [{"law": "auto"}]}
    assert Fields(Document.from_values(values)).unit(("motion", 0, "to")) == "°"


@pytest.mark.parametrize(
    ("value", "data"),
    [
        (Decimal("1.5"), 1.5), (Decimal("NaN"), None), (10**400, None), (2**60, float(2**60)),
        ("x" * 10_000, "x" * 400), ([Decimal(1)] * 1000, [1.0] * 400), (True, True),
        ({"a": {"b": Decimal("2.5")}}, {"a": {"b": 2.5}}),
    ],
)  # fmt: skip
def test_values_are_for_json_and_of_bounded_size(value: Any, data: Any) -> None:
    assert plain(value) == data
    json.dumps(plain(value), allow_nan=False)
