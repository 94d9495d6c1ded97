"""`camgeo slotted-lever`: the SAM exercise to the digit, its table, and what is refused."""

from __future__ import annotations

import csv
import io
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.slotted_lever import FULL_TURN, NAMES, slotted_lever
from camgeo.errors import GeometryError
from tests.cli.calling import FIXTURES, Called, called

EXERCISE = ("--frame", "150", "--swing", "60", "--speed", "90")
"""a = 150 mm, a swing of 60 degrees, n = 1.5 1/s."""

COLUMNS = ("crank_deg", "time_s", "phi_deg", "omega2", "eps2")
"""Columns of the printed table, in the order of `NAMES`."""


def call(*words: object) -> Called:
    return called("slotted-lever", *words)


def rows_of(*words: object) -> list[list[str]]:
    """The table that a call prints."""
    head, *rows = csv.reader(io.StringIO(call(*words, "--table").out))
    assert tuple(head) == NAMES
    return rows


def printed() -> list[list[str]]:
    text = (FIXTURES / "tables" / "crank-slide_printed.csv").read_text("utf-8")
    head, *rows = csv.reader(io.StringIO(text))
    assert tuple(head) == COLUMNS
    assert len(rows) == 361
    return rows


def errata() -> list[dict[str, str]]:
    path = FIXTURES / "tables" / "crank-slide_errata.csv"
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def differing(rows: list[list[str]], *, as_text: bool = False) -> set[tuple[str, str]]:
    """Crank angle and column of the cells that are not those of the printed table."""
    return {
        (theirs[0], name)
        for ours, theirs in zip(rows, printed(), strict=True)
        for name, mine, other in zip(COLUMNS, ours, theirs, strict=True)
        if (mine != other if as_text else Decimal(mine) != Decimal(other))
    }


def test_the_printed_table_cell_by_cell() -> None:
    """1805 cells; those that differ are listed, and are those whose exact value rounds so, or five
    zeros with another sign.
    """
    rows, listed = rows_of(*EXERCISE, "--printed"), errata()
    by_angle = {row[0]: dict(zip(COLUMNS, row, strict=True)) for row in rows}
    wrong = set()
    for each in listed:
        exact = Decimal(each["exact_n_1.5"]).quantize(Decimal("0.001"))
        assert Decimal(by_angle[each["crank_deg"]][each["column"]]) == exact
        if exact != Decimal(each["printed"]):
            wrong.add((each["crank_deg"], each["column"]))
    assert (len(listed), len(wrong)) == (146, 137)
    assert differing(rows) == wrong
    known = {(each["crank_deg"], each["column"]) for each in listed}
    assert differing(rows, as_text=True) - known == {
        ("60", "omega2"), ("300", "omega2"), ("180", "phi_deg"), ("180", "eps2"),
        ("360", "phi_deg"),
    }  # fmt: skip


def test_the_table_at_the_time_of_a_turn_that_sam_had() -> None:
    """0.66667 s instead of 2/3 s: 23 cells differ, those that the list says."""
    speed = Decimal(60) / Decimal("0.66667")
    found = differing(rows_of("--frame", "150", "--swing", "60", "--speed", speed, "--printed"))
    left = {
        (each["crank_deg"], each["column"])
        for each in errata()
        if each["matches_rounding_T_0.66667"] == "no"
    }
    assert len(left) == 23
    assert found == left


def test_the_same_table_as_json_and_in_a_file(tmp_path: Path) -> None:
    rows = rows_of(*EXERCISE, "--step", "5")
    columns = call(*EXERCISE, "--table", "--step", "5", "--json").document["table"]
    assert columns == {
        name: [float(row[number]) for row in rows] for number, name in enumerate(NAMES)
    }
    assert "table" not in call(*EXERCISE, "--json").document
    target = tmp_path / "lever.csv"
    found = call(*EXERCISE, "--csv", target, "--step", "5")
    assert target.read_text("utf-8") == call(*EXERCISE, "--table", "--step", "5").out
    assert f"{target}: 73 rows" in found.err


def test_table_and_picture_are_written_together_or_not_at_all(tmp_path: Path) -> None:
    table, picture = tmp_path / "lever.csv", tmp_path / "lever.svg"
    picture.write_text("mine")
    assert call(*EXERCISE, "--csv", table, "-o", picture).code == 2
    assert [path.name for path in tmp_path.iterdir()] == ["lever.svg"]
    assert picture.read_text() == "mine"
    assert call(*EXERCISE, "--csv", table, "-o", picture, "--force").code == 0
    assert b"<svg" in picture.read_bytes()
    assert len(table.read_text().splitlines()) == 362


def test_extreme_lengths_and_speeds_give_finite_numbers() -> None:
    for frame in ("1e-100", "1e100"):
        for crank in ("1e-100", "1e100"):
            for speed in ("1e-100", "1e100"):
                words = ("--frame", frame, "--crank", crank, "--speed", speed, "--from", "1")
                table = call(*words, "--to", "359", "--table", "--json").document["table"]
                assert np.all(np.isfinite(np.array(list(table.values()))))


def test_a_crank_or_a_swing_is_needed() -> None:
    with pytest.raises(GeometryError, match="needed") as caught:
        slotted_lever(150.0, 90.0, rows=FULL_TURN)
    assert caught.value.key == "crank"
