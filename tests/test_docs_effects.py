"""docs/effects.md covers every effect, as declared and as the example scenes show it."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.kinematics.laws import FAMILIES
from camgeo.part.materials import MATERIALS
from tests.answers.documents import explained
from tests.effects.recorded import record
from tests.long_form import LONG
from tests.pages import page_maker

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGE = (DOCS / "effects.md").read_text(encoding="utf-8")

SCENES = sorted(path.stem for path in (ROOT / "fixtures" / "effects").glob("*.toml"))

TIMES = re.compile(r"^ +\d+\.\d{3} +\d+\.\d{3}  ", re.MULTILINE)
"""Milliseconds of `camgeo explain`, of one machine."""

CLAIM = re.compile(r"<= (\de[+-]?\d+)")
"""Estimates of errors, which are held on their own."""

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")

CLOSE = 1e-3
"""Largest share by which a number may be off. The page has three to six digits; another processor
rounds otherwise, which moves the last one, and the place of a flat extreme by more."""

ROUNDING = 1e-9
"""Numbers up to this are rounding of 0."""


@cache
def maker() -> Any:
    """The module docs/effects_page.py, with the designs that the tests of answers explain."""
    made = page_maker("effects_page")
    made.explained = lambda scene: explained(made.SCENES / f"{scene}.toml")
    return made


def masked(text: str) -> tuple[str, list[float]]:
    """The text without numbers, and these."""
    text = CLAIM.sub("claim", TIMES.sub("times  ", text))
    return NUMBER.sub("#", text), [float(number) for number in NUMBER.findall(text)]


def section(name: str) -> str:
    """The section of the page on an effect."""
    (text,) = re.findall(rf"^## {name}\n.*?(?=^## |\Z)", PAGE, flags=re.MULTILINE | re.DOTALL)
    return str(text)


# Its parts are held below, and what it says of findings and columns against the record of results.
@pytest.mark.long
def test_the_page_is_made_from_its_texts_and_the_code() -> None:
    """With estimates, for which every effect is computed six times."""
    text, numbers = masked(maker().page())
    written, figures = masked(PAGE)
    assert text == written, "run python docs/effects_page.py"
    off = [
        (number, figure)
        for number, figure in zip(numbers, figures, strict=True)
        if not math.isclose(number, figure, rel_tol=CLOSE, abs_tol=ROUNDING)
    ]
    assert not off, "run python docs/effects_page.py"


def test_a_number_that_is_off_is_seen() -> None:
    text, numbers = masked("largest drive torque 9.9285 N m at cam angle 96.7355 deg, <= 2e-9")
    assert text == "largest drive torque # N m at cam angle # deg, claim"
    assert numbers == [9.9285, 96.7355]
    assert masked("     1.234     0.567  effects.load")[0] == "times  effects.load"
    assert masked("-3.08e-11 %")[1] == [-3.08e-11]


def test_every_effect_has_its_section_in_the_order_of_the_registry() -> None:
    heads = re.findall(r"^## (.+)$", PAGE, flags=re.MULTILINE)
    assert [head for head in heads if head in EFFECTS] == list(EFFECTS)
    rows = re.findall(r"^\| \[([a-z-]+)\]\(#\1\)", PAGE, flags=re.MULTILINE)
    assert rows == list(EFFECTS)


@pytest.mark.parametrize("name", EFFECTS)
def test_a_section_states_model_findings_and_sources(name: str) -> None:
    text = section(name)
    assert "| finding | |" in text
    assert re.search(r"^\*\*Sources?:\*\* ", text, re.MULTILINE)
    assert ("umerical.*" in text) == find_effect(name).numerical
    assert f"scene.md#effects{name}" in text
    assert f"## `[effects.{name}]`" in (DOCS / "scene.md").read_text(encoding="utf-8")


def told_findings(name: str) -> set[str]:
    """Names of findings in the section of an effect: the first cells of its table."""
    cells = re.findall(r"^\| (`[^|]*`) \|", section(name), flags=re.MULTILINE)
    return {found for cell in cells for found in re.findall(r"`([^`]+)`", cell)}


def told_columns(name: str) -> set[str]:
    """Names of columns in the section of an effect."""
    found = re.search(r"^\*\*Columns?:\*\* (.*?)\n\n", section(name), re.MULTILINE | re.DOTALL)
    return set(re.findall(r"`([^`]+)`", found[1].replace("\n", " "))) if found else set()


COMMON = {
    "contact-lost",
    "clearance-crossed",
    "trimmed-motion",
    "elastic-train",
    "simplified",
    "found-speed",
}
"""Findings that any effect may have; the section on conventions has them."""


SIDES = ("main ", "return ", "opposite ", "return-", "opposite-")
"""Before the name of a finding or column, of one side of a follower that is held both ways."""


def unsided(names: set[str], told: set[str]) -> set[str]:
    """The `names`, without their side where the section does not tell them with it."""
    return {
        next((name.removeprefix(side) for side in SIDES if name.startswith(side)), name)
        if name not in told
        else name
        for name in names
    }


def test_findings_of_all_effects_are_listed_once() -> None:
    assert {name for name in COMMON if f"\n| `{name}` |" in PAGE} == COMMON


@cache
def found_of(name: str) -> tuple[set[str], set[str]]:
    """Names of findings and of columns that an effect has in the example scenes."""
    findings, columns = set(), set()
    for scene in SCENES:
        found = record()[scene].get(name, {})
        findings |= {each for each, _ in found.get("findings", ())}
        columns |= {*found.get("columns", ())}
    return findings, columns


@pytest.mark.parametrize("name", EFFECTS)
def test_findings_of_an_effect_are_reported(name: str) -> None:
    findings, columns = found_of(name)
    assert findings
    told = told_findings(name) | COMMON
    assert unsided(findings, told) <= told
    assert unsided(columns, told_columns(name)) <= told_columns(name)


def written_of(name: str) -> list[str]:
    """The texts in the code of an effect as patterns: anything may stand for what they put in."""
    place = ROOT / "camgeo" / "dynamics" / "effects" / name.replace("-", "_")
    files = sorted(place.glob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
    files.append(ROOT / "camgeo" / "dynamics" / "effects" / "forces.py")  # shared
    found = [text for file in files for text in re.findall(r'"([^"\n]+)"', file.read_text("utf-8"))]
    parts = [re.split(r"\{[^}]*\}", text) for text in found]
    return ["[a-z]+".join(map(re.escape, each)) for each in parts if any(each)]


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_can_find_what_is_reported(name: str) -> None:
    """In an example scene, or by the name in its code."""
    findings, columns = found_of(name)
    rest = (told_findings(name) - findings) | (told_columns(name) - columns)
    patterns = written_of(name)
    # A load of `camgeo.dynamics.effects.reactions` names its finding.
    patterns += [f"largest-{text.replace(re.escape(' '), '-')}" for text in patterns]
    assert [each for each in rest if not any(re.fullmatch(p, each) for p in patterns)] == []


@pytest.mark.skipif(not LONG, reason="the estimates are computed in the long form")
def test_no_error_is_larger_than_the_page_says() -> None:
    made = maker()
    rows = re.findall(r"^\| (.*?) \| (exact .*|<= .*) \|$", section("Accuracy"), re.MULTILINE)
    assert len(rows) > len(made.estimates("press"))
    for name, row in rows:
        effect, _, scene = name.partition(" of ")
        found = made.estimates(scene or "press")[effect]
        *cells, off = row.split(" | ")
        # One that reaches rounding at once is not computed again.
        assert set(cells[len(found) :]) <= {"the same"}
        for (error, _), cell, tolerance in zip(found, cells, made.TOLERANCES, strict=False):
            if error is None:
                assert cell == "exact"
            else:
                assert error <= float(cell.removeprefix("<= "))
                assert error <= tolerance
        assert (found[0][1] or 0.0) <= float(off.removeprefix("<= "))


def test_claims_are_twice_what_was_estimated_rounded_up() -> None:
    claim = maker().claim
    assert [claim(value) for value in (0.0, 1e-12, 1.01e-12, 4.6e-4)] == [
        "<= 1e-13",
        "<= 2e-12",
        "<= 3e-12",
        "<= 1e-3",
    ]


def test_every_law_from_rest_to_rest_has_its_spectrum() -> None:
    rows = re.findall(r"^\| (.+?) \|", section("shock-spectrum"), flags=re.MULTILINE)
    reported = {name for row in rows for name in row.split(", ")}
    assert {name for name, family in FAMILIES.items() if "R-R" in family.parameters} <= reported


def test_residuals_are_those_of_closed_forms() -> None:
    """The largest from one period a move on, which all three have there.

    A parabola's acceleration is 4 and -4: what remains is 4/(2 pi r)^2 |1 - exp(i pi r)|^2, which
    is 16/(2 pi)^2 at r = 1. The harmonic motion's is cos(pi r)/(4 r^2 - 1), a third there; the
    inclined sine's sin(pi r)/(pi r (1 - r^2)), a half in the limit.
    """
    first = {
        name: float(share)
        for names, share in re.findall(
            r"^\| ([a-z0-9, -]+) \| ([\d.]+) \|", section("shock-spectrum"), flags=re.MULTILINE
        )
        for name in names.split(", ")
    }
    half_digit = 0.05  # of three digits in per cent
    assert first["quadratic-parabola"] == pytest.approx(400.0 / math.pi**2, abs=half_digit)
    assert first["simple-sine"] == pytest.approx(100.0 / 3.0, abs=half_digit)
    assert first["inclined-sine"] == pytest.approx(50.0, abs=half_digit)


def test_every_material_has_its_source() -> None:
    rows = re.findall(r"^\| `([a-z0-9-]+)` \|.*\| (.+) \|$", section("Materials"), re.MULTILINE)
    assert rows == [(each.name, each.source) for each in MATERIALS.values()]


@pytest.mark.parametrize(
    "name", ["effects-spectrum", pytest.param("effects-groove", marks=pytest.mark.long)]
)
def test_a_picture_can_be_drawn(name: str) -> None:
    assert maker().picture(name).startswith(b"\x89PNG")
