"""Pages that scripts in docs write are as these write them now, with all texts and figures."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.scene.toml import MECHANISMS
from tests.pages import page_maker
from tests.reference import THESIS_CAMS, reference
from tests.stability.measure import Reading
from tests.stability.quick import CASES as SUITE
from tests.stability.quick import quick
from tests.stability.suite import GROUPS, LIMIT, Row

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


STABILITY = (DOCS / "stability.md").read_text(encoding="utf-8")

LINE = re.compile(
    r"^\| `(?P<quantity>[^`]+)` \| (?P<count>\d+) \| <= (?P<error>[\de.]+) \| [\de.]+ \|"
    r" <= (?P<ratio>[\de.]+) \| (?P<case>.+) \|$",
    flags=re.MULTILINE,
)

CLAIMS = {row["quantity"]: row for row in LINE.finditer(STABILITY)}

MEASURED = re.compile(r"\| \d+ \| <= [\de.]+ \| [\de.]+ \| <= [\de.]+ \| .+ \|$", re.MULTILINE)
"""What differs between a quick run and a whole one."""


def stability_page() -> Any:
    """The module docs/stability_page.py."""
    return page_maker("stability_page")


# Compared by `.ci/full`; below is what a reader would miss.
@pytest.mark.long
def test_the_page_is_made_from_its_texts_and_the_suite() -> None:
    made = stability_page().page(SUITE, quick())
    assert MEASURED.sub("", made) == MEASURED.sub("", STABILITY), (
        "run python docs/stability_page.py"
    )


def test_every_quantity_has_its_line_with_all_its_values() -> None:
    counts: dict[str, int] = {}
    for case in SUITE:
        for quantity in case.quantities:
            counts[quantity] = counts.get(quantity, 0) + len(case.places)
    assert {name: int(row["count"]) for name, row in CLAIMS.items()} == counts
    assert all(any(case.name == row["case"] for case in SUITE) for row in CLAIMS.values())


@pytest.mark.parametrize("quantity", CLAIMS)
def test_a_quick_run_stays_within_the_figures_of_the_page(quantity: str) -> None:
    found = [reading for reading in quick() if reading.quantity == quantity]
    assert found
    assert max(reading.error for reading in found) <= float(CLAIMS[quantity]["error"])
    ratio = float(CLAIMS[quantity]["ratio"])
    assert max(reading.ratio for reading in found) <= ratio <= LIMIT


def test_every_group_has_its_row() -> None:
    assert re.findall(r"^\*\*(.+)\*\*: ", STABILITY, flags=re.MULTILINE)[-len(GROUPS) :] == list(
        GROUPS
    )


def made_up(error: float, conditioning: float) -> Row:
    reading = Reading("a | b", "cams", "made up", 1.0, 1.0, error, conditioning)
    return Row("a | b", 7, reading, reading)


def test_claims_are_twice_what_was_measured_rounded_up() -> None:
    page = stability_page()
    assert [page.rounded_up(value) for value in (0.0, 2.0, 2.01, 9.5, 1.1e-3)] == [
        0, 2, 3, 10, 2e-3,
    ]  # fmt: skip
    assert page.table_row(made_up(1.3, 0.5)) == "| `a \\| b` | 7 | <= 3 | 0.5 | <= 3 | made up |\n"
    assert (
        page.table_row(made_up(6e14, 7e15))
        == "| `a \\| b` | 7 | <= 2e15 | 7e15 | <= 1 | made up |\n"
    )
    assert page.claimed_ratio(made_up(60.0, 1.0)) == LIMIT


OPTICURV = page_maker("opticurv_page")

PUBLISHED = {"schnitt": 6.7, "setzhub": 5.1, "vorschub": 1.3}
"""Largest error of the working curves [mm] as the reference collection has it (section 8)."""


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_program_with_its_faults_mended_agrees_with_camgeo(name: str) -> None:
    """So the port is faithful, and there are no other faults, except for mue."""
    found, true = OPTICURV.opticurv(OPTICURV.numbers_of(name), ()), OPTICURV.right(name)
    assert tuple(found) == tuple(true)
    for column, values in true.items():
        if column == "mue":
            continue
        there, here = found[column], values
        if column == "r_K":
            there, here = 1.0 / there, 1.0 / here
        assert abs(there - here).max() < OPTICURV.AGREE, column


@pytest.mark.parametrize("fault", OPTICURV.FAULTS)
def test_each_fault_alone_makes_the_program_wrong(fault: str) -> None:
    name = "querhub"  # the only one with the answer that fault "sign" needs
    found, true = OPTICURV.opticurv(OPTICURV.numbers_of(name), (fault,)), OPTICURV.right(name)
    assert abs(1.0 / found["r_K"] - 1.0 / true["r_K"]).max() > 1e-3


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_errors_of_the_working_curves_are_the_published_ones(name: str) -> None:
    found, true = OPTICURV.opticurv(OPTICURV.numbers_of(name)), OPTICURV.right(name)
    for flank in ("i", "a"):
        assert round(float(OPTICURV.off(found, true, flank).max()), 1) == PUBLISHED[name]
    assert OPTICURV.off(found, true, "B").max() < 1e-12 * 100.0


def test_mue_of_the_program_is_90_degrees_in_a_dwell() -> None:
    columns = OPTICURV.opticurv(OPTICURV.numbers_of("setzhub"))
    first = columns["phi"] < 110.0
    # arccos of a cosine that is 1 except for some roundings.
    assert abs(columns["mue"][first] - 90.0).max() < np.degrees(np.sqrt(32.0 * 2.0**-52))


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_right_columns_have_the_extremes_of_the_reference(name: str) -> None:
    """At steps of 0.5 degrees, so on the far side of the extremes and near them."""
    expected = reference("thesis_examples.toml")[THESIS_CAMS[name]]["results_sigma_minus1"]
    true = OPTICURV.right(name)
    swing = true["psi"][abs(true["psi"]).argmax()]
    assert swing == pytest.approx(expected["psi_extreme"], abs=1e-12)
    radius = np.hypot(true["x_B_vers"], true["y_B_vers"])
    assert radius.min() == pytest.approx(expected["r_min"], abs=1e-12)
    assert radius.max() == pytest.approx(expected["r_max"], abs=1e-12)
    assert expected["mu_min"] <= true["mue"].min() < expected["mu_min"] + 0.05
    convex = true["r_K"][true["r_K"] > 0.0].min()
    assert expected["rho_convex_min"] <= convex < expected["rho_convex_min"] * 1.01
