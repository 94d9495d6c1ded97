"""Some of the cases of `tests.draws.extremes`, with a fixed seed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.draws.extremes import cases, misses_of

SEED = 0x2026

STEP = 0.02
"""Of the grid [deg], ten times that of the program."""


@pytest.mark.parametrize("case", [*cases(SEED, 3, 2)], ids=lambda case: case[0])
def test_nothing_is_beyond_what_is_told(
    case: tuple[str, object, str | None], tmp_path: Path
) -> None:
    name, values, rows = case
    assert misses_of(values, rows, tmp_path, sizes=name.startswith("plan 3"), step=STEP) == []
