"""docs/ripple.md has all its rows, and some of them are measured again."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.studies.accuracy.benefit import BenefitRow, benefit_rows
from camgeo.studies.accuracy.contours import FORMS
from camgeo.units import RPM
from tests.pages import page_maker

PAGE: Final = (Path(__file__).resolve().parents[1] / "docs" / "ripple.md").read_text("utf-8")

EXTREMES, SPECTRUM = PAGE.split("## At which frequencies")


@cache
def maker() -> Any:
    """The module docs/ripple_page.py."""
    return page_maker("ripple_page")


@cache
def measured() -> tuple[BenefitRow, ...]:
    speeds = [speed * RPM for speed in maker().SPEEDS]
    return benefit_rows(maker().design(), (1e-1, 1e-3), speeds)


def numbers(line: str) -> list[float]:
    return [float(text) for text in re.findall(r"(?<=[ |])-?[\d.e-]*\d", line)]


def test_every_contour_has_every_tolerance() -> None:
    for form in FORMS:
        found = re.findall(
            rf"^\| {maker().NAMES[form]} \| ([\de.-]+) \| \S+ % ", PAGE, re.MULTILINE
        )
        assert [float(each) for each in found] == list(maker().TOLERANCES)


@pytest.mark.long  # tests/accuracy/test_benefit.py and test_spectrum.py measure such rows
def test_rows_measured_again_are_those_of_the_page() -> None:
    """To two units of the last of three digits: another processor rounds pieces differently."""
    for line in maker().lines(measured()):
        head = " | ".join(line.split(" | ")[:2]) + " | "
        (kept,) = (each for each in EXTREMES.splitlines() if each.startswith(head))
        assert numbers(line) == pytest.approx(numbers(kept), rel=0.02)


@pytest.mark.long  # the long form alone has the rows
def test_the_picture_is_drawn_from_the_rows() -> None:
    drawn = maker().benefit_figure(measured(), title="setzhub")
    assert [panel.y.label for panel in drawn.panels] == [
        "acceleration is off [mm/s²]",
        "contact force is off [N]",
        "lifts off at [rev/min]",
    ]
    assert len(drawn.panels[0].marks) == len(FORMS) * len(maker().SPEEDS)
    assert drawn.to_data()


@pytest.mark.long  # tests/accuracy/test_benefit.py and test_spectrum.py measure such rows
def test_harmonics_measured_again_are_those_of_the_page() -> None:
    """To a unit of the last of two digits."""
    for line in maker().spectrum_lines(maker().at_highest_speed(measured())):
        head = " | ".join(line.split(" | ")[:2]) + " | "
        (kept,) = (each for each in SPECTRUM.splitlines() if each.startswith(head))
        found, wanted = (numbers(each.replace(",", "")) for each in (line, kept))
        assert found == pytest.approx(wanted, rel=0.1)


@pytest.mark.long  # the long form alone has the rows
def test_the_spectrum_has_a_line_for_each_tolerance() -> None:
    drawn = maker().spectrum_figure(maker().at_highest_speed(measured()), title="setzhub")
    assert [len(panel.marks) for panel in drawn.panels] == [2] * len(FORMS)
    assert drawn.to_data()
