"""A few of the discs of `tests.draws.circular`, each format once."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Final

import pytest

from tests.draws.circular import FACETED, PLANE, SHOP, Case, case_of, misses, write

SEED: Final = 39


def _cases() -> list[tuple[Case, str]]:
    rng = Random(SEED)
    cases = [case_of(rng, number) for number in range(40)]
    return [
        (next(each for each in cases[number:] if name in each.formats), name)
        for number, name in enumerate(PLANE + FACETED + SHOP)
    ]


@pytest.mark.parametrize(("case", "name"), _cases(), ids=lambda each: getattr(each, "kind", each))
def test_a_circle_is_built_as_one(case: Case, name: str, tmp_path: Path) -> None:
    write(case, name, tmp_path)
    assert [*misses(case, name, tmp_path)] == []
