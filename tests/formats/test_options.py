"""Options check their own values, wherever they come from."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import Any

import pytest

from camgeo.scene.formats.csv import LARGEST_STEP, SMALLEST_STEP, CsvSpec
from camgeo.scene.formats.dxf import ENTITIES, DxfSpec
from camgeo.scene.formats.format import find_format
from tests.part.parts import refused


@pytest.mark.parametrize(
    ("make", "value", "key"),
    [
        *(
            (CsvSpec, Decimal(text), "output.csv.step")
            for text in ("0", "-1", "91", "NaN", "sNaN", "Inf")
        ),
        *(
            (CsvSpec, value, "output.csv.step")
            for value in (91.0, 0, float("nan"), "1", None, True)
        ),
        *((DxfSpec, value, "output.dxf.entity") for value in ("", "arc", None, 3)),
    ],
)
def test_wrong_options_are_refused(make: Callable[[Any], Any], value: Any, key: str) -> None:
    with refused(key, "must be"):
        make(value)


def test_the_ends_of_the_ranges_are_in_them() -> None:
    assert [CsvSpec(Decimal(text)).step for text in ("0.001", "90")]
    assert CsvSpec(90).step == LARGEST_STEP  # type: ignore[arg-type]  # numbers of Python pass too
    node = find_format("csv").schema["properties"]["step"]
    assert (Decimal(repr(node["minimum"])), node["maximum"]) == (SMALLEST_STEP, LARGEST_STEP)
    assert [DxfSpec(entity).entity for entity in ENTITIES] == list(ENTITIES)
    assert find_format("dxf").schema["properties"]["entity"]["enum"] == list(ENTITIES)
