"""Pages that scripts in docs write are as these write them now, with all their texts."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from camgeo.scene.toml import MECHANISMS
from tests.pages import page_maker

DOCS = Path(__file__).resolve().parents[1] / "docs"

MECHANISMS_PAGE, MILLING_PAGE = page_maker("mechanisms_page"), page_maker("milling_page")

NOTHING = r"(?!)"

SIZES = r" +[\d,]+ (?=bytes)"
"""Processors round the last digits of coordinates differently, and a trailing 0 is not written."""

FIGURES = r"(?<=<= )\de[+-]?\d+|\d+\.\d{6,}"
"""Bounds of errors, and figures with so many digits that the last may differ."""

# What is long is compared by `.ci/full`; what a reader would miss is in the tests of that page.
SCRIPTS = [
    ("answers", NOTHING),
    ("machines", NOTHING),
    ("hard-cases", FIGURES),
    *(
        pytest.param(name, left_out, marks=pytest.mark.long)
        for name, left_out in (
            ("laws", NOTHING), ("mechanisms", NOTHING), ("milling", SIZES), ("opticurv", NOTHING),
            ("sizing", NOTHING),
        )
    ),
]  # fmt: skip
"""Pages, and what is left out of the comparison."""


@pytest.mark.parametrize(("name", "left_out"), SCRIPTS)
def test_a_page_is_made_by_its_script(name: str, left_out: str) -> None:
    script = f"{name.replace('-', '_')}_page"
    written = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    made, found = (re.sub(left_out, "", each) for each in (page_maker(script).page(), written))
    assert made == found, f"run python docs/{script}.py"


def test_the_schemas_that_are_shipped_are_those_of_the_answers() -> None:
    maker = page_maker("answers_page")
    for name in maker.packages():
        assert maker.schema_file(name).read_text(encoding="utf-8") == maker.schema_text(name), (
            "run python docs/answers_page.py"
        )


@pytest.mark.parametrize(
    ("folder", "used"),
    [
        ("mechanisms", {"conventions", *MECHANISMS_PAGE.MECHANISMS, *MECHANISMS_PAGE.LATER}),
        ("milling", set(MILLING_PAGE.PARTS)),
    ],
)
def test_no_text_is_left_out(folder: str, used: set[str]) -> None:
    assert {path.stem for path in (DOCS / folder).glob("*.md")} == used


def test_every_mechanism_of_camgeo_new_has_its_section_and_picture() -> None:
    text, names = (DOCS / "mechanisms.md").read_text(encoding="utf-8"), MECHANISMS_PAGE.MECHANISMS
    assert sorted(names) == sorted(MECHANISMS)
    heads = re.findall(r"^## (.+)$", text, flags=re.MULTILINE)
    assert [head for head in heads if head in names] == list(names)
    shown = re.findall(r"\(images/(mechanism-[a-z-]+\.png)\)", text)
    assert shown == [f"mechanism-{name}.png" for name in names]


def test_every_job_stands_on_the_page_of_milling() -> None:
    jobs = {path.stem for path in (DOCS.parent / "fixtures" / "milling").glob("*.toml")}
    assert {scene for scene, _ in MILLING_PAGE.JOBS} == jobs
    shown = re.findall(
        r"\(images/(milling-[a-z]+)\.png\)", (DOCS / "milling.md").read_text(encoding="utf-8")
    )
    assert shown == list(MILLING_PAGE.PICTURES)
