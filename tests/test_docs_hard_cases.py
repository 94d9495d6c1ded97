"""docs/hard-cases.md covers every hard case, and no error is larger than it says."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.pages import page_maker
from tests.reference import reference

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "hard-cases.md").read_text(encoding="utf-8")

CASES = [case["id"] for case in reference("hard_cases.json")]

BOUND = re.compile(r"<= (\de[+-]?\d+)")


def maker() -> Any:
    """The module docs/hard_cases_page.py."""
    return page_maker("hard_cases_page")


def section(case: str) -> str:
    """The section of the page on a case."""
    (text,) = re.findall(rf"^## {case}: .*?(?=^## |\Z)", PAGE, flags=re.MULTILINE | re.DOTALL)
    return str(text)


def test_every_case_has_its_section_and_there_are_no_others() -> None:
    assert re.findall(r"^## (\w+): ", PAGE, flags=re.MULTILINE) == CASES
    texts = tomllib.loads((DOCS / "hard_cases.toml").read_text(encoding="utf-8"))
    assert list(texts) == CASES
    for case in CASES:
        assert "| <= " in section(case) or "exact |" in section(case) or "\n> " in section(case)


@pytest.mark.parametrize("case", CASES)
def test_no_error_is_larger_than_the_page_says(case: str) -> None:
    lines = maker().measured(case)
    rows = re.findall(r"^\| (.*) \| (exact|<= .*) \|$", section(case), flags=re.MULTILINE)
    assert [row[0].replace("\\|", "|") for row in rows] == [line.label for line in lines]
    for line, (_, claim) in zip(lines, rows, strict=True):
        bound = BOUND.match(claim)
        assert line.error <= (float(bound[1]) if bound else 0.0), line.label


def test_an_error_is_measured_from_all_digits_of_the_reference() -> None:
    line = maker().share("a third", (1.0 / 3.0, "0." + 30 * "3"))
    # The double nearest to 1/3 is 2^-54/3 below it.
    assert line.error == pytest.approx(2.0**-54, rel=1e-9)
    off = maker().distance("a point", "mm", 1.0, (3.0 + 4.0j, ["0", "0"]))
    assert off.error == 5.0


def test_errors_are_rounded_up() -> None:
    rounded_up = maker().rounded_up
    assert [rounded_up(value) for value in (0.0, 1e-15, 1.01e-15, 9.5e-3)] == [
        0,
        1e-15,
        2e-15,
        1e-2,
    ]
