"""Requests check what they are made of, and travel in pickles and copies."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from dataclasses import fields
from decimal import Decimal
from typing import Any

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.plan import Dwell
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import (
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
)

ROW = np.array([0.25, 0.5])
SPAN = Decimal(60)

SOUND: dict[type, dict[str, Any]] = {
    Unit: {"name": "mm", "size": 1.0},
    Dwell: {"span": SPAN},
    MoveRequest: {"span": SPAN, "to": 10.0, "law": "auto"},
    PointsRequest: {"span": SPAN, "to": 10.0, "shares": ROW, "positions": ROW},
    TableRequest: {"span": SPAN, "shares": ROW, "lifts": ROW},
}

NO_NUMBERS: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -math.inf,
    1e308,
    "60",
    True,
    1j,
    [60.0],
    10**400,
    Decimal("NaN"),
    Decimal("sNaN"),
    Decimal("Infinity"),
    Decimal("1e-999999"),
    Decimal("1e999999"),
)

WRONG: list[tuple[type, str, Any]] = [
    *((kind, "span", value) for kind in SOUND if kind is not Unit for value in (*NO_NUMBERS, None)),
    *((kind, "span", value) for kind in SOUND if kind is not Unit for value in (-60, 360.5)),
    *((kind, "span", Decimal("5e-7")) for kind in (MoveRequest, PointsRequest, TableRequest)),
    *((kind, "to", value) for kind in (MoveRequest, PointsRequest) for value in NO_NUMBERS),
    *((kind, "to", value) for kind in (MoveRequest, PointsRequest) for value in (None, 5e-324)),
    *((MoveRequest, key, v) for key in ("velocity", "acceleration", "jerk") for v in NO_NUMBERS),
    *((PointsRequest, key, v) for key in ("velocity", "acceleration") for v in NO_NUMBERS),
    *((MoveRequest, "law", value) for value in ("polynomal", None, 3, ["auto"])),
    *((MoveRequest, "balance", value) for value in ("velocity", None, 3)),
    *((MoveRequest, "optimise", value) for value in (3, {1: 1.0}, {"torque": 1.0})),
    (MoveRequest, "parameters", [("sine", 0.5)]),
    *(
        (kind, "shares", v)
        for kind in (PointsRequest, TableRequest)
        for v in (None, "ab", [1j, 2j])
    ),
    *((kind, "shares", [0.1]) for kind in (PointsRequest, TableRequest)),
    (PointsRequest, "given", {2: (0.0, None)}),
    (PointsRequest, "given", {"0": (0.0, None)}),
    (PointsRequest, "given", {0: 3.0}),
    (PointsRequest, "given", {0: (math.nan, None)}),
    *((TableRequest, "smoothing", value) for value in (*NO_NUMBERS, 0.0, -1.0, 5e-324)),
    *((Unit, "size", value) for value in (*NO_NUMBERS, 0.0, -1.0, 5e-324, None)),
]


@pytest.mark.parametrize(
    ("kind", "key", "value"), WRONG, ids=lambda each: getattr(each, "__name__", None)
)
def test_a_wrong_value_is_reported_with_its_key(kind: type, key: str, value: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        kind(**(SOUND[kind] | {key: value}))
    reported = {"shares": ("shares", "positions", "lifts")}.get(key, (key,))
    assert caught.value.key in reported
    assert len(caught.value.value) <= 60


@pytest.mark.parametrize("weight", [-1.0, 0.0, math.nan, "1"])
def test_a_wrong_weight_is_reported_with_its_name(weight: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        MoveRequest(SPAN, 1.0, "auto", optimise={"jerk": weight})
    assert caught.value.key == "jerk"


@pytest.mark.parametrize("requests", [None, 3, [None], ["dwell"], [Dwell(SPAN), 3]])
def test_only_requests_are_planned(requests: Any) -> None:
    with pytest.raises(GeometryError, match="a sequence of requests"):
        plan_motion(requests)


def test_numbers_of_any_kind_are_spans_as_they_are_written() -> None:
    for value in (np.float64(0.1), 0.1, Decimal("0.1"), np.int64(3), 3):
        assert Dwell(value).span == Decimal(str(value))  # type: ignore[arg-type]  # any number is allowed


@pytest.mark.parametrize(
    "travel", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))]
)
@pytest.mark.parametrize("kind", SOUND)
def test_requests_travel(travel: Callable[[Request], Request], kind: type) -> None:
    request = kind(**SOUND[kind])
    found = travel(request)
    assert type(found) is kind
    for each in fields(kind):
        value, same = getattr(found, each.name), getattr(request, each.name)
        if isinstance(same, np.ndarray):
            assert not value.flags.writeable
        assert type(value) is type(same)
        assert np.array_equal(value, same)
