"""`camgeo table --law`: the value table of a normalised law."""

from __future__ import annotations

import csv
import io
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.laws import PARAMETERS
from camgeo.app.answers.table import law_table
from camgeo.kinematics.laws import FAMILIES, make_law
from tests.cli.calling import FIXTURES, called


def read(text: str) -> tuple[list[str], list[list[str]]]:
    head, *rows = csv.reader(io.StringIO(text))
    return head, rows


@pytest.mark.parametrize(
    ("name", "task", "options"),
    [
        ("inclined-sine", "R-R", {"inflection": 0.4}),
        ("polynomial-5", "B-B", {"v0": -0.25, "a0": 1.5, "v1": 0.75, "a1": -2.0}),
    ],
)
def test_the_law_is_made_of_its_options(name: str, task: str, options: dict[str, float]) -> None:
    words = [word for key, value in options.items() for word in (f"--{key}", value)]
    found = called("table", "--step", "0.1", "--law", name, "--task", task, *words)
    values = np.array(read(found.out)[1], dtype=np.float64)
    law = make_law(name, task, **options)
    assert np.array_equal(values, law_table(law, Decimal("0.1")).values)
    # The ends are as asked: the normalised conditions hold up to rounding.
    for place, end in ((0, "0"), (-1, "1")):
        stated = [options.get(f"{key}{end}", 0.0) for key in "va"]
        assert values[place, 1:4] == pytest.approx([float(end), *stated], abs=1e-12)


def test_the_printed_table_is_the_guideline_s_but_for_what_is_listed() -> None:
    """As text, with the guideline's errata corrected as listed; its step is the default."""
    corrected = {}
    for name in ("errata.csv", "rounding.csv"):
        with (FIXTURES / "tables" / name).open(newline="", encoding="utf-8") as file:
            for cell in csv.DictReader(file):
                if cell["table"] == "mod_sine":
                    corrected[cell["z"], cell["column"]] = cell["correct_rounded"]
    head, rows = read((FIXTURES / "tables" / "modified-sine_printed.csv").read_text("utf-8"))
    lines = [",".join(head)]
    for row in rows:
        cells = zip(head[1:], row[1:], strict=True)
        right = (corrected.pop((row[0], column), text) for column, text in cells)
        lines.append(",".join((row[0], *right)))
    assert not corrected
    assert called("table", "--law", "modified-sine", "--printed").out.splitlines() == lines


def test_there_is_an_option_for_every_parameter_of_every_law() -> None:
    taken = {
        name
        for family in FAMILIES.values()
        for names in family.parameters.values()
        for name in names
    }
    assert taken == PARAMETERS.keys()


@pytest.mark.parametrize("name", sorted(PARAMETERS.keys() - {"inflection"}))
def test_a_parameter_that_the_law_has_not_is_named(name: str) -> None:
    """From rest to rest, the 3-4-5 polynomial has an inflection point to place and no more."""
    found = called("table", "--law", "polynomial-345", f"--{name}", "0.5")
    assert (found.code, found.out) == (2, "")
    assert f"{name} = 0.5: " in found.err
    assert f"takes no {name}; its parameters: inflection\n" in found.err


def test_a_document_goes_into_the_file_that_is_named(tmp_path: Path) -> None:
    target, call = tmp_path / "table.json", ("table", "--law", "modified-sine", "--json")
    assert called(*call, "-o", target).code == 0
    assert target.read_text("utf-8") == called(*call).out
