"""docs/stability.md covers every quantity of the suite, and a quick run keeps its claims."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from tests.pages import page_maker
from tests.stability.measure import Reading
from tests.stability.quick import CASES, quick
from tests.stability.suite import GROUPS, LIMIT, Row

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "stability.md").read_text(encoding="utf-8")

ROW = re.compile(
    r"^\| `(?P<quantity>[^`]+)` \| (?P<count>\d+) \| <= (?P<error>[\de.]+) \| [\de.]+ \|"
    r" <= (?P<ratio>[\de.]+) \| (?P<case>.+) \|$",
    flags=re.MULTILINE,
)

CLAIMS = {row["quantity"]: row for row in ROW.finditer(PAGE)}

MEASURED = re.compile(r"\| \d+ \| <= [\de.]+ \| [\de.]+ \| <= [\de.]+ \| .+ \|$", re.MULTILINE)
"""What differs between a quick run and a whole one."""


def maker() -> Any:
    """The module docs/stability_page.py."""
    return page_maker("stability_page")


# Compared by `.ci/full`; below is what a reader would miss.
@pytest.mark.long
def test_the_page_is_made_from_its_texts_and_the_suite() -> None:
    made = maker().page(CASES, quick())
    assert MEASURED.sub("", made) == MEASURED.sub("", PAGE), "run python docs/stability_page.py"


def test_every_quantity_has_its_line_with_all_its_values() -> None:
    counts: dict[str, int] = {}
    for case in CASES:
        for quantity in case.quantities:
            counts[quantity] = counts.get(quantity, 0) + len(case.places)
    assert {name: int(row["count"]) for name, row in CLAIMS.items()} == counts
    assert all(any(case.name == row["case"] for case in CASES) for row in CLAIMS.values())


@pytest.mark.parametrize("quantity", CLAIMS)
def test_a_quick_run_stays_within_the_figures_of_the_page(quantity: str) -> None:
    found = [reading for reading in quick() if reading.quantity == quantity]
    assert found
    assert max(reading.error for reading in found) <= float(CLAIMS[quantity]["error"])
    ratio = float(CLAIMS[quantity]["ratio"])
    assert max(reading.ratio for reading in found) <= ratio <= LIMIT


def test_every_group_has_its_row() -> None:
    assert re.findall(r"^\*\*(.+)\*\*: ", PAGE, flags=re.MULTILINE)[-len(GROUPS) :] == list(GROUPS)


def made_up(error: float, conditioning: float) -> Row:
    reading = Reading("a | b", "cams", "made up", 1.0, 1.0, error, conditioning)
    return Row("a | b", 7, reading, reading)


def test_claims_are_twice_what_was_measured_rounded_up() -> None:
    page = maker()
    assert [page.rounded_up(value) for value in (0.0, 2.0, 2.01, 9.5, 1.1e-3)] == [
        0, 2, 3, 10, 2e-3,
    ]  # fmt: skip
    assert page.table_row(made_up(1.3, 0.5)) == "| `a \\| b` | 7 | <= 3 | 0.5 | <= 3 | made up |\n"
    assert (
        page.table_row(made_up(6e14, 7e15))
        == "| `a \\| b` | 7 | <= 2e15 | 7e15 | <= 1 | made up |\n"
    )
    assert page.claimed_ratio(made_up(60.0, 1.0)) == LIMIT
