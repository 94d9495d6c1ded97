"""docs/accuracy.md covers every fixture cam, and some of its rows are measured again."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import camgeo
from camgeo.geometry.contour.least_pieces import ARC, CHORD, CUBIC
from camgeo.studies.accuracy.benefit import benefit_rows
from camgeo.studies.accuracy.contours import FORMS, ORDER
from camgeo.studies.accuracy.knee import enough, words
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
    assert f"at 600 rev/min: {words(enough(rows))}" in " ".join(PAGE.split())


def test_the_constants_are_those_of_the_limits() -> None:
    assert "| straight pieces | 2 | kappa | 1/16 |" in PAGE
    assert CHORD == 1.0 / 16.0
    assert "| arcs, tangent | 3 | d kappa/ds | sqrt(3)/216 |" in PAGE
    assert pytest.approx(3.0**0.5 / 216.0) == ARC
    assert "| cubic spline, C2 | 4 | kappa'' - kappa^3 | 1/768 |" in PAGE
    assert CUBIC == 1.0 / 768.0
    reported = [float(text) for text in re.findall(r"\| ([\d.]+) times", PAGE)]
    assert reported == [round(10.0 ** (1.0 / ORDER[form]), 2) for form in FORMS]
