"""`camgeo table --law`: the value table of a normalised law."""

from __future__ import annotations

import csv
import io
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.laws import PARAMETERS
from camgeo.app.cli.main import main
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.tables import law_table

FIXTURES = Path(__file__).parents[2] / "fixtures"

SETZHUB = str(FIXTURES / "scenes" / "setzhub.toml")

Capture = pytest.CaptureFixture[str]


def read(text: str) -> tuple[list[str], list[list[str]]]:
    head, *rows = csv.reader(io.StringIO(text))
    return head, rows


def numbers(text: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array(read(text)[1], dtype=np.float64)


def test_the_law_is_made_of_its_options(capsys: Capture) -> None:
    call = ["table", "--step", "0.1", "--law"]
    assert main([*call, "inclined-sine", "--inflection", "0.4"]) == 0
    expected = law_table(make_law("inclined-sine", inflection=0.4), Decimal("0.1")).values
    assert np.array_equal(numbers(capsys.readouterr().out), expected)
    ends = {"v0": -0.25, "a0": 1.5, "v1": 0.75, "a1": -2.0}
    options = [text for name, value in ends.items() for text in (f"--{name}", str(value))]
    assert main([*call, "polynomial-5", "--task", "B-B", *options]) == 0
    values = numbers(capsys.readouterr().out)
    assert np.array_equal(
        values, law_table(make_law("polynomial-5", "B-B", **ends), Decimal("0.1")).values
    )
    # The ends are as asked: the normalised conditions hold up to rounding.
    assert values[0, 1:4] == pytest.approx([0.0, -0.25, 1.5], abs=1e-12)
    assert values[-1, 1:4] == pytest.approx([1.0, 0.75, -2.0], abs=1e-12)


def test_the_printed_table_is_the_guideline_s_but_for_what_is_listed(capsys: Capture) -> None:
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
    assert main(["table", "--law", "modified-sine", "--printed"]) == 0
    assert capsys.readouterr().out.splitlines() == lines


def refused(call: list[str], capsys: Capture) -> str:
    """The error of a wrong call; its exit code must be 2, and nothing else is printed."""
    assert main(["table", *call]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err


LAW = ["--law", "modified-sine"]


def test_there_is_an_option_for_every_parameter_of_every_law() -> None:
    taken = {
        name
        for family in FAMILIES.values()
        for names in family.parameters.values()
        for name in names
    }
    assert taken == PARAMETERS.keys()


@pytest.mark.parametrize("name", sorted(PARAMETERS.keys() - {"inflection"}))
def test_a_parameter_that_the_law_has_not_is_named(name: str, capsys: Capture) -> None:
    """From rest to rest, the 3-4-5 polynomial has an inflection point to place and no more."""
    reported = refused(["--law", "polynomial-345", f"--{name}", "0.5"], capsys)
    assert f"{name} = 0.5: " in reported
    assert f"takes no {name}; its parameters: inflection\n" in reported


def test_a_document_goes_into_the_file_that_is_named(tmp_path: Path, capsys: Capture) -> None:
    target = tmp_path / "table.json"
    call = ["table", "--law", "modified-sine", "--step", "0.1", "--json"]
    assert main(call) == 0
    printed = capsys.readouterr().out
    assert main([*call, "-o", str(target)]) == 0
    assert target.read_text("utf-8") == printed
