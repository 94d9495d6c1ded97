"""docs/bill.md has every fixture scene, and its figures but seconds and bytes are found again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.pages import page_maker

PAGE = (Path(__file__).resolve().parents[1] / "docs" / "bill.md").read_text(encoding="utf-8")

COSTS, BUYS = PAGE.split("## What it buys")

DIGITS = 1e-2
"""Relative change of a figure by one in the last of three digits, at most."""


def maker() -> Any:
    """The module docs/bill_page.py."""
    return page_maker("bill_page")


def cells(row: str) -> list[str]:
    """The cells of a row, without those at its ends, which are empty."""
    return [cell.strip() for cell in row.split("|")[1:-1]]


def rows(text: str, name: str) -> list[list[str]]:
    """The rows of a scene."""
    return [cells(row) for row in text.splitlines() if row.startswith(f"| {name} |")]


def number(cell: str) -> float | str:
    """The number in a cell; the cell itself if there is none."""
    try:
        return float(cell.replace(",", ""))
    except ValueError:
        return cell


def assert_close(found: list[str], written: list[str]) -> None:
    for one, other in zip(map(number, found), map(number, written), strict=True):
        assert one == (other if isinstance(other, str) else pytest.approx(other, rel=DIGITS))


def test_every_fixture_scene_is_built_and_runs() -> None:
    made = maker()
    for name in made.scenes():
        assert [row[1] for row in rows(COSTS, name)] == [f"{each:g}" for each in made.TOLERANCES]
        assert rows(BUYS, name), name


@pytest.mark.long  # tests/accuracy/test_bill.py measures such rows
@pytest.mark.parametrize("name", ["tappet", "effects/yoke"])
def test_what_is_built_again_is_that_of_the_page(name: str) -> None:
    """Pieces and machining time."""
    made = maker()
    (built,) = made.measure(name, made.TOLERANCES[:1])
    found, written = cells(made.line(name, built)), rows(COSTS, name)[0]
    assert_close([*found[:2], found[8], found[10]], [*written[:2], written[8], written[10]])


@pytest.mark.long  # tests/accuracy/test_bill.py measures such rows
@pytest.mark.parametrize("name", ["tappet", "effects/groove_lever"])
def test_what_runs_again_is_that_of_the_page(name: str) -> None:
    made = maker()
    found = [cells(row) for row in made.lines(name, made.bought(name))]
    for one, other in zip(found, rows(BUYS, name), strict=True):
        assert_close(one, other)
