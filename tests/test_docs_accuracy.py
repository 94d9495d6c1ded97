"""Pages on accuracy, what it costs and what it buys: all their rows, some measured again."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

import camgeo
from camgeo.geometry.contour.arcs import ARC
from camgeo.studies.accuracy.benefit import (
    BenefitRow,
    benefit_rows,
    find_sufficient,
    sufficient_sentence,
)
from camgeo.studies.accuracy.contours import CHORD, CUBIC, FORMS, ORDER
from camgeo.units import RPM
from tests.pages import page_maker

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGE = (DOCS / "accuracy.md").read_text(encoding="utf-8")

AGAIN = ["plate_translating"]
"""Cams that are measured again, at the tolerances that take no time."""

COARSE = (1e-2, 1e-3)


CELL = ((1.0, 0.0), (0.0, 0.1), (0.0, 0.1))
"""Largest difference and largest share of it: another processor rounds otherwise, which may be a
piece more or less, and that in contours of 14 pieces and more with it 7 per cent of the ratios."""

SIZES = ((1.0, 0.02),) * 3
SECONDS = (*((0.1, 0.0),) * 2, *((0.1, 0.1),) * 2)

ALLOWED = ((0.0, 0.0), *CELL, *CELL, *CELL, *SIZES, *SECONDS)
"""Of the numbers of a line: tolerance, cells of the three forms, thousands of bytes, seconds at the
feed of the scene and of the shortest round, where a piece more puts a corner elsewhere."""


def maker() -> Any:
    """The module docs/accuracy_page.py."""
    return page_maker("accuracy_page")


def section(name: str) -> str:
    return PAGE.split(f"### {name}\n")[1].split("\n## ")[0].split("\n### ")[0]


def numbers(line: str) -> list[float]:
    return [float(text.replace(",", "")) for text in re.findall(r"(?<=[ |])[\d,.]*\d", line)]


def test_the_page_begins_with_its_text() -> None:
    assert PAGE.startswith(maker().HEAD), "run python docs/accuracy_page.py"


def test_the_page_has_every_fixture_cam() -> None:
    assert re.findall(r"^### (\S+)$", PAGE, re.MULTILINE) == maker().scenes()


@pytest.mark.parametrize("name", maker().scenes())
def test_a_cam_has_its_tolerances_and_its_advice(name: str) -> None:
    rows = re.findall(r"^\| ([\de.-]+) \|", section(name), re.MULTILINE)
    assert [float(tolerance) for tolerance in rows] == list(maker().TOLERANCES)
    paragraphs = section(name).split("\n\n")
    (sentence,) = (each.strip() for each in paragraphs if each.startswith("Advice: "))
    assert re.search(r"\d pieces, .*;.*\.$", sentence, re.DOTALL)


@pytest.mark.long  # tests/accuracy/test_contours.py measures such rows
@pytest.mark.parametrize("name", AGAIN)
def test_figures_measured_again_are_those_of_the_page(name: str) -> None:
    found = maker().by_key(maker().rows_of(name, COARSE))
    for tolerance in COARSE:
        made = maker().line(found, tolerance)
        begin = f"| {tolerance:g} |"
        (line,) = (each for each in section(name).splitlines(True) if each.startswith(begin))
        assert re.sub(r"[\d,.]+", "", made) == re.sub(r"[\d,.]+", "", line)
        for reported, found_again, (most, share) in zip(
            numbers(line), numbers(made), ALLOWED, strict=True
        ):
            assert found_again == pytest.approx(reported, abs=most, rel=share)


@pytest.mark.long  # tests/accuracy/test_contours.py measures such rows
def test_the_answer_at_a_speed_is_what_is_measured() -> None:
    speed = 600.0 * RPM
    rows = benefit_rows(
        camgeo.load(maker().SCENES / "setzhub.toml"), maker().AT_SPEED, (speed,), forms=("arcs",)
    )
    listed = ",".join(f"{tolerance:.0e}".replace("e-0", "e-") for tolerance in maker().AT_SPEED)
    assert f"--tolerances {listed} --speed 600\n" in PAGE
    assert f"at 600 rev/min: {sufficient_sentence(find_sufficient(rows))}" in " ".join(PAGE.split())


def test_the_constants_are_those_of_the_limits() -> None:
    assert "| straight pieces | 2 | kappa | 1/16 |" in PAGE
    assert CHORD == 1.0 / 16.0
    assert "| arcs, tangent | 3 | d kappa/ds | sqrt(3)/216 |" in PAGE
    assert pytest.approx(3.0**0.5 / 216.0) == ARC
    assert "| cubic spline, C2 | 4 | kappa'' - kappa^3 | 1/768 |" in PAGE
    assert CUBIC == 1.0 / 768.0
    reported = [float(text) for text in re.findall(r"\| ([\d.]+) times", PAGE)]
    assert reported == [round(10.0 ** (1.0 / ORDER[form]), 2) for form in FORMS]


BILL = (Path(__file__).resolve().parents[1] / "docs" / "bill.md").read_text(encoding="utf-8")

COSTS, BUYS = BILL.split("## What it buys")

DIGITS = 1e-2
"""Relative change of a figure by one in the last of three digits, at most."""


def bill() -> Any:
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
    made = bill()
    for name in made.scenes():
        assert [row[1] for row in rows(COSTS, name)] == [f"{each:g}" for each in made.TOLERANCES]
        assert rows(BUYS, name), name


@pytest.mark.long  # tests/accuracy/test_bill.py measures such rows
@pytest.mark.parametrize("name", ["tappet", "effects/yoke"])
def test_what_is_built_again_is_that_of_the_page(name: str) -> None:
    """Pieces and machining time."""
    made = bill()
    (built,) = made.measure(name, made.TOLERANCES[:1])
    found, written = cells(made.line(name, built)), rows(COSTS, name)[0]
    assert_close([*found[:2], found[8], found[10]], [*written[:2], written[8], written[10]])


@pytest.mark.long  # tests/accuracy/test_bill.py measures such rows
@pytest.mark.parametrize("name", ["tappet", "effects/groove_lever"])
def test_what_runs_again_is_that_of_the_page(name: str) -> None:
    made = bill()
    found = [cells(row) for row in made.lines(name, made.bought(name))]
    for one, other in zip(found, rows(BUYS, name), strict=True):
        assert_close(one, other)


RIPPLE: Final = (Path(__file__).resolve().parents[1] / "docs" / "ripple.md").read_text("utf-8")

EXTREMES, SPECTRUM = RIPPLE.split("## At which frequencies")


@cache
def ripple() -> Any:
    """The module docs/ripple_page.py."""
    return page_maker("ripple_page")


@cache
def measured() -> tuple[BenefitRow, ...]:
    speeds = [speed * RPM for speed in ripple().SPEEDS]
    return benefit_rows(ripple().design(), (1e-1, 1e-3), speeds)


def signed(line: str) -> list[float]:
    return [float(text) for text in re.findall(r"(?<=[ |])-?[\d.e-]*\d", line)]


def test_every_contour_has_every_tolerance() -> None:
    for form in FORMS:
        found = re.findall(
            rf"^\| {ripple().NAMES[form]} \| ([\de.-]+) \| \S+ % ", RIPPLE, re.MULTILINE
        )
        assert [float(each) for each in found] == list(ripple().TOLERANCES)


@pytest.mark.long  # tests/accuracy/test_benefit.py and test_spectrum.py measure such rows
@pytest.mark.parametrize(("made", "page", "rel"), [
    (lambda: ripple().lines(measured()), EXTREMES, 0.02),
    (lambda: ripple().spectrum_lines(ripple().at_highest_speed(measured())), SPECTRUM, 0.1),
])  # fmt: skip
def test_rows_measured_again_are_those_of_the_page(
    made: Callable[[], list[str]], page: str, rel: float
) -> None:
    """To two units of the last of three digits, and one of the last of two: another processor
    rounds pieces differently.
    """
    for line in made():
        head = " | ".join(line.split(" | ")[:2]) + " | "
        (kept,) = (each for each in page.splitlines() if each.startswith(head))
        found, wanted = (signed(each.replace(",", "")) for each in (line, kept))
        assert found == pytest.approx(wanted, rel=rel)


@pytest.mark.long  # the long form alone has the rows
def test_the_pictures_are_drawn_from_the_rows() -> None:
    drawn = ripple().benefit_figure(measured(), title="setzhub")
    assert [panel.y.label for panel in drawn.panels] == [
        "acceleration is off [mm/s²]",
        "contact force is off [N]",
        "lifts off at [rev/min]",
    ]
    assert len(drawn.panels[0].marks) == len(FORMS) * len(ripple().SPEEDS)
    spectrum = ripple().spectrum_figure(ripple().at_highest_speed(measured()), title="setzhub")
    assert [len(panel.marks) for panel in spectrum.panels] == [2] * len(FORMS)
    assert drawn.to_data()
    assert spectrum.to_data()
