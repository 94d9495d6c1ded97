"""`camgeo slotted-lever`: the SAM exercise to the digit, the hard cases, and what is refused."""

from __future__ import annotations

import csv
import io
import json
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.app.answers.slotted_lever import FULL_TURN, slotted_lever
from camgeo.app.cli.main import main
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slotted_lever import (
    NAMES,
)

FIXTURES = Path(__file__).parents[2] / "fixtures" / "tables"

EXERCISE = ("--frame", "150", "--swing", "60", "--speed", "90")
"""a = 150 mm, a swing of 60 degrees, n = 1.5 1/s."""

COLUMNS = ("crank_deg", "time_s", "phi_deg", "omega2", "eps2")
"""Columns of the printed table, in the order of `NAMES`."""

Capture = pytest.CaptureFixture[str]


def call(*words: str) -> int:
    return main(["slotted-lever", *words])


def output(capsys: Capture, *words: str) -> str:
    assert call(*words) == 0
    return capsys.readouterr().out


def document(capsys: Capture, *words: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(output(capsys, *words, "--json"))
    return found


def rows_of(text: str) -> list[list[str]]:
    head, *rows = csv.reader(io.StringIO(text))
    assert tuple(head) == NAMES
    return rows


def printed() -> list[list[str]]:
    text = (FIXTURES / "crank-slide_printed.csv").read_text("utf-8")
    head, *rows = csv.reader(io.StringIO(text))
    assert tuple(head) == COLUMNS
    assert len(rows) == 361
    return rows


def errata() -> list[dict[str, str]]:
    with (FIXTURES / "crank-slide_errata.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def differing(rows: list[list[str]]) -> set[tuple[str, str]]:
    """Crank angle and column of the cells that are not those of the printed table."""
    return {
        (theirs[0], name)
        for ours, theirs in zip(rows, printed(), strict=True)
        for name, mine, other in zip(COLUMNS, ours, theirs, strict=True)
        if Decimal(mine) != Decimal(other)
    }


# The exercise -------------------------------------------------------------------------------------


def test_the_printed_table_cell_by_cell(capsys: Capture) -> None:
    """1805 cells; those that differ are listed, and are those whose exact value rounds so."""
    rows = rows_of(output(capsys, *EXERCISE, "--table", "--printed"))
    listed = errata()
    assert len(listed) == 146
    thousandth = Decimal("0.001")
    wrong = {
        (each["crank_deg"], each["column"])
        for each in listed
        if Decimal(each["exact_n_1.5"]).quantize(thousandth) != Decimal(each["printed"])
    }
    assert differing(rows) == wrong
    assert len(wrong) == 137
    by_angle = {row[0]: dict(zip(COLUMNS, row, strict=True)) for row in rows}
    for each in listed:
        cell = by_angle[each["crank_deg"]][each["column"]]
        assert Decimal(cell) == Decimal(each["exact_n_1.5"]).quantize(thousandth)


def test_what_else_differs_in_print_are_the_signs_of_five_zeros(capsys: Capture) -> None:
    rows = rows_of(output(capsys, *EXERCISE, "--table", "--printed"))
    listed = {(each["crank_deg"], each["column"]) for each in errata()}
    by_text = {
        (theirs[0], name)
        for ours, theirs in zip(rows, printed(), strict=True)
        for name, mine, other in zip(COLUMNS, ours, theirs, strict=True)
        if mine != other
    }
    assert by_text - listed == {
        ("60", "omega2"), ("300", "omega2"), ("180", "phi_deg"), ("180", "eps2"),
        ("360", "phi_deg"),
    }  # fmt: skip


def test_the_table_at_the_time_of_a_turn_that_sam_had(capsys: Capture) -> None:
    """0.66667 s instead of 2/3 s: 23 cells differ, those that the list says."""
    speed = str(Decimal(60) / Decimal("0.66667"))
    words = ("--frame", "150", "--swing", "60", "--speed", speed, "--table", "--printed")
    found = differing(rows_of(output(capsys, *words)))
    left = {
        (each["crank_deg"], each["column"])
        for each in errata()
        if each["matches_rounding_T_0.66667"] == "no"
    }
    assert len(left) == 23
    assert found == left


# The table ----------------------------------------------------------------------------------------


def test_a_part_of_the_turn_with_a_last_shorter_step(capsys: Capture) -> None:
    words = ("--table", "--from", "10", "--to", "20.5", "--step", "0.7", "--printed")
    angles = [row[0] for row in rows_of(output(capsys, *EXERCISE, *words))]
    assert (angles[0], angles[1], angles[-2], angles[-1]) == ("10.0", "10.7", "19.8", "20.5")
    assert len(angles) == 16
    assert all(Decimal(two) - Decimal(one) == Decimal("0.7") for one, two in pairwise(angles))
    cut = output(capsys, *EXERCISE, "--table", "--from", "10", "--to", "20.6", "--step", "0.7")
    assert [row[0] for row in rows_of(cut)][-2:] == ["20.5", "20.6"]


def test_the_same_table_as_json_and_in_a_file(tmp_path: Path, capsys: Capture) -> None:
    text = output(capsys, *EXERCISE, "--table", "--step", "5")
    columns = document(capsys, *EXERCISE, "--table", "--step", "5")["table"]
    rows = rows_of(text)
    assert columns == {
        name: [float(row[number]) for row in rows] for number, name in enumerate(NAMES)
    }
    assert "table" not in document(capsys, *EXERCISE)
    target = tmp_path / "lever.csv"
    assert call(*EXERCISE, "--csv", str(target), "--step", "5") == 0
    captured = capsys.readouterr()
    assert target.read_text("utf-8") == text
    assert f"{target}: 73 rows" in captured.err
    assert "time ratio" in captured.out
    # The same again needs no force, another table does.
    assert call(*EXERCISE, "--csv", str(target), "--step", "5") == 0
    assert call(*EXERCISE, "--csv", str(target), "--step", "6") == 2
    assert target.read_text("utf-8") == text
    assert call(*EXERCISE, "--csv", str(target), "--step", "6", "--force") == 0


def test_table_and_picture_are_written_together_or_not_at_all(
    tmp_path: Path, capsys: Capture
) -> None:
    table, picture = tmp_path / "lever.csv", tmp_path / "lever.svg"
    picture.write_text("mine")
    assert call(*EXERCISE, "--csv", str(table), "-o", str(picture)) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["lever.svg"]
    assert picture.read_text() == "mine"
    assert call(*EXERCISE, "--csv", str(table), "-o", str(picture), "--force") == 0
    assert b"<svg" in picture.read_bytes()
    assert len(table.read_text().splitlines()) == 362
    capsys.readouterr()


# Sizes, and the hard cases ------------------------------------------------------------------------


# What is refused ----------------------------------------------------------------------------------


def test_extreme_lengths_and_speeds_give_finite_numbers(capsys: Capture) -> None:
    for frame in ("1e-100", "1e100"):
        for crank in ("1e-100", "1e100"):
            for speed in ("1e-100", "1e100"):
                words = ("--frame", frame, "--crank", crank, "--speed", speed)
                found = document(capsys, *words, "--table", "--from", "1", "--to", "359")
                assert np.all(np.isfinite(np.array(list(found["table"].values()))))


def test_a_crank_or_a_swing_is_needed() -> None:
    with pytest.raises(GeometryError, match="needed") as caught:
        slotted_lever(150.0, 90.0, rows=FULL_TURN)
    assert caught.value.key == "crank"
