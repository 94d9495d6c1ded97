"""`camgeo slotted-lever`: the SAM exercise to the digit, the hard cases, and what is refused."""

from __future__ import annotations

import csv
import io
import json
import math
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.app.cli.main import main
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slotted_lever import (
    NAMES,
    DrivenLever,
    SlottedLever,
    crank_for_swing,
)
from tests.reference import hard_case

FIXTURES = Path(__file__).parents[2] / "fixtures" / "tables"

EXERCISE = ("--frame", "150", "--swing", "60", "--speed", "90")
"""a = 150 mm, a swing of 60 degrees, n = 1.5 1/s."""

COLUMNS = ("crank_deg", "time_s", "phi_deg", "omega2", "eps2")
"""Columns of the printed table, in the order of `NAMES`."""

EPS = 2.0**-52
LIMIT = 64.0 * EPS
"""16 spacings of the kinematics (tests/mechanism), and a few more for the change of units."""

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


def extreme(record: dict[str, Any], quantity: str, *, largest: bool) -> dict[str, Any]:
    (found,) = [
        each
        for each in record["extremes"]
        if each["quantity"] == quantity and each["largest"] == largest
    ]
    return dict(found)


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


def test_the_extremes_named_in_the_text_of_the_exercise(capsys: Capture) -> None:
    found = document(capsys, *EXERCISE)
    assert found["crank_mm"] == 75.0
    assert found["ratio"] == 2.0
    assert found["turn_s"] == pytest.approx(2.0 / 3.0, rel=LIMIT)
    assert found["swing_deg"] == pytest.approx(60.0, rel=LIMIT)
    # phi_max = -30 degrees at 60, 0.111 s; 30 degrees at 300, 0.556 s.
    for largest, angle, crank, time in ((False, -30.0, 60.0, 1 / 9), (True, 30.0, 300.0, 5 / 9)):
        end = extreme(found, "phi", largest=largest)
        assert math.degrees(end["value"]) == pytest.approx(angle, rel=LIMIT)
        assert end["crank_deg"] == pytest.approx(crank, rel=LIMIT)
        assert end["time_s"] == pytest.approx(time, rel=LIMIT)
    # omega_2: 9.425 rad/s (540 deg/s) at 0, 3.142 rad/s (180 deg/s) at 180.
    back, forth = (extreme(found, "omega2", largest=largest) for largest in (False, True))
    assert math.degrees(back["value"]) == pytest.approx(-540.0, rel=LIMIT)
    assert back["crank_deg"] == back["phi_deg"] == 0.0
    assert math.degrees(forth["value"]) == pytest.approx(180.0, rel=LIMIT)
    assert (forth["crank_deg"], forth["phi_deg"]) == (180.0, 0.0)
    # eps_2: the text has the largest row of the table, 119.881 at 23 and 337 degrees.
    for largest, crank, time, phi in (
        (True, 22.9030618658217, 0.0424130775, -19.8361245911597),
        (False, 360.0 - 22.9030618658217, 2.0 / 3.0 - 0.0424130775, 19.8361245911597),
    ):
        peak = extreme(found, "eps2", largest=largest)
        assert peak["value"] == pytest.approx(119.883473983041 * (1 if largest else -1), rel=1e-14)
        assert peak["crank_deg"] == pytest.approx(crank, rel=1e-13)
        assert peak["time_s"] == pytest.approx(time, abs=0.5e-10)
        assert peak["phi_deg"] == pytest.approx(phi, rel=1e-14)
    assert found["time_ratio"] == pytest.approx(2.0, rel=LIMIT)
    slow, quick = found["strokes"]
    assert slow["crank_to_deg"] - slow["crank_from_deg"] == pytest.approx(240.0, rel=LIMIT)
    assert quick["crank_to_deg"] - quick["crank_from_deg"] == pytest.approx(120.0, rel=LIMIT)
    assert slow["duration_s"] / quick["duration_s"] == pytest.approx(2.0, rel=LIMIT)


def test_the_text_has_them_too(capsys: Capture) -> None:
    lines = output(capsys, *EXERCISE).splitlines()
    table = {" ".join(line.split()[:2]): line.split()[2:] for line in lines}
    assert table["smallest phi"] == ["-0.5235988", "rad", "-30", "deg", "60", "0.1111111", "-30"]
    assert table["largest phi"][2:6] == ["30", "deg", "300", "0.5555556"]
    assert table["smallest omega2"][:5] == ["-9.424778", "rad/s", "-540", "deg/s", "0"]
    assert table["largest omega2"][:5] == ["3.141593", "rad/s", "180", "deg/s", "180"]
    assert table["largest eps2"][0] == "119.8835"
    assert table["largest eps2"][4:] == ["22.90306", "0.04241308", "-19.83612"]
    assert table["smallest eps2"][4:] == ["337.0969", "0.6242536", "19.83612"]
    assert table["time ratio"] == ["2"]
    assert any("--table" in line for line in lines)


# The table ----------------------------------------------------------------------------------------


def test_both_halves_of_the_table_agree_to_the_last_digit(capsys: Capture) -> None:
    """phi and eps_2 are odd about 180 degrees, omega_2 is even; at 180 degrees zeros are zeros."""
    for words in (EXERCISE, ("--frame", "50", "--crank", "80", "--speed", "33.3")):
        rows = rows_of(output(capsys, *words, "--table", "--step", "0.1"))
        values = np.array([[float(cell) for cell in row] for row in rows])
        assert len(values) == 3601
        assert np.array_equal(values[:, 2], -values[::-1, 2])
        assert np.array_equal(values[:, 3], values[::-1, 3])
        assert np.array_equal(values[:, 4], -values[::-1, 4])
        assert (values[1800, 2], values[1800, 4]) == (0.0, 0.0)
        assert "-0.0" not in {cell for row in rows for cell in row}


def test_the_columns_are_derivatives_of_each_other(capsys: Capture) -> None:
    rows = rows_of(output(capsys, *EXERCISE, "--table", "--step", "0.05"))
    _, time, phi, omega, eps = np.array([[float(cell) for cell in row] for row in rows]).T
    step = float(time[1])
    for lower, upper, exact in ((np.radians(phi), omega, omega), (omega, eps, eps)):
        difference = (lower[2:] - lower[:-2]) / (2.0 * step)
        # h^2/6 of the third derivative, which follows from the second differences of the exact one.
        bound = np.abs(np.diff(upper, 2)).max() / 6.0
        rounding = 2.0 * EPS * np.abs(lower).max() / step
        assert np.max(np.abs(difference - exact[1:-1])) <= 2.0 * bound + 4.0 * rounding


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


@pytest.mark.parametrize("swing", ["0.001", "1", "60", "90", "120.5", "179", "179.99"])
def test_the_crank_makes_the_swing_that_is_asked(swing: str, capsys: Capture) -> None:
    found = document(capsys, "--frame", "150", "--swing", swing, "--speed", "90")
    half = math.radians(float(swing)) / 2.0
    # The crank is rounded once more than the sine: two spacings, over the tangent's slope.
    loss = 4.0 * EPS * math.tan(half) / half
    assert found["swing_deg"] == pytest.approx(float(swing), rel=loss + LIMIT)
    by_crank = document(
        capsys, "--frame", "150", "--crank", repr(found["crank_mm"]), "--speed", "90"
    )
    assert by_crank == found


def test_a_crank_as_long_as_the_frame(capsys: Capture) -> None:
    """HC01: phi = theta/2 - 90 degrees, in the sense of the crank; no finding at 0 and 360."""
    _, expected = hard_case("HC01")
    for size in (("--crank", "150"), ("--swing", "180")):
        words = ("--frame", "150", *size, "--speed", "90")
        found = document(capsys, *words)
        assert (found["swings"], found["extremes"], found["strokes"]) == (False, [], None)
        assert found["time_ratio"] is None
        text = output(capsys, *words)
        assert "undefined" in text
        assert "omega2 is 4.712389 rad/s everywhere" in text
        for ends, key in (((), "from = 0"), (("--from", "1"), "to = 360")):
            assert call(*words, "--table", *ends) == 2
            captured = capsys.readouterr()
            assert captured.out == ""
            assert key in captured.err
            assert "undefined" in captured.err
        small = ("--from", "0.00000001", "--to", "359")
        rows = rows_of(output(capsys, *words, "--table", *small))
        first = float(expected["phi_deg_at_theta_1e_minus_8_deg"])
        assert float(rows[0][2]) == pytest.approx(-first, rel=1e-15)
        for row in rows:
            assert float(row[2]) == pytest.approx(0.5 * float(row[0]) - 90.0, abs=90.0 * LIMIT)
            assert float(row[3]) == pytest.approx(-float(expected["omega2"]), rel=LIMIT)
            assert float(row[4]) == 0.0


def test_a_crank_nearly_as_long_as_the_frame(capsys: Capture) -> None:
    """HC02, with lengths whose difference is exact."""
    _, expected = hard_case("HC02")
    words = ("--frame", "1000000001", "--crank", "1000000000", "--speed", "90")
    found = document(capsys, *words)
    value = {key: float(text) for key, text in expected.items() if key != "asymptotic"}
    assert 0.5 * found["swing_deg"] == pytest.approx(value["phi_max_deg"], rel=1e-12)
    end = extreme(found, "phi", largest=False)
    assert math.radians(end["crank_deg"]) == pytest.approx(value["theta_phi_max_rad"], rel=1e-12)
    peak = extreme(found, "eps2", largest=True)
    assert peak["value"] == pytest.approx(value["max_abs_eps2"], rel=1e-12)
    place = value["theta_of_max_eps_rad"]
    assert math.radians(peak["crank_deg"]) == pytest.approx(place, rel=1e-12)
    fast = extreme(found, "omega2", largest=False)
    slow = extreme(found, "omega2", largest=True)
    assert fast["value"] == pytest.approx(-value["omega2_at_0"], rel=1e-12)
    assert slow["value"] == pytest.approx(-value["omega2_at_180"], rel=1e-12)


def test_a_lever_that_turns_round(capsys: Capture) -> None:
    """HC03: no largest angle, no strokes, one turn of the lever with each of the crank."""
    _, expected = hard_case("HC03")
    words = ("--frame", "50", "--crank", "100", "--speed", "90")
    found = document(capsys, *words)
    assert not found["swings"]
    assert (found["swing_deg"], found["strokes"], found["time_ratio"]) == (None, None, None)
    assert {each["quantity"] for each in found["extremes"]} == {"omega2", "eps2"}
    fast, slow = (extreme(found, "omega2", largest=largest) for largest in (True, False))
    assert fast["value"] == pytest.approx(-float(expected["omega2_at_0"]), rel=1e-12)
    assert (fast["crank_deg"], fast["phi_deg"]) == (0.0, -180.0)
    assert slow["value"] == pytest.approx(-float(expected["omega2_at_180"]), rel=1e-12)
    peak = extreme(found, "eps2", largest=False)
    assert peak["value"] == pytest.approx(-float(expected["max_abs_eps2"]), rel=1e-12)
    assert peak["crank_deg"] == pytest.approx(float(expected["theta_of_max_deg"]), rel=1e-12)
    rows = {row[0]: row for row in rows_of(output(capsys, *words, "--table", "--printed"))}
    assert (rows["0"][2], rows["360"][2]) == ("-180.000", "180.000")
    exact = {row[0]: row for row in rows_of(output(capsys, *words, "--table", "--step", "30"))}
    for angle, phi in expected["phi_deg_unwrapped"].items():
        assert float(exact[f"{angle}.0"][2]) == pytest.approx(-float(phi), rel=1e-12)
    assert "time ratio, because" in output(capsys, *words)


def test_a_very_short_crank(capsys: Capture) -> None:
    """HC04: equation (9) has no digit left there."""
    _, expected = hard_case("HC04")
    words = ("--frame", "1e8", "--crank", "1", "--speed", "90", "--table", "--to", "90")
    rows = {row[0]: row for row in rows_of(output(capsys, *words))}
    for angle in ("1", "90"):
        phi = float(expected[f"phi_deg_at_{angle}"])
        assert float(rows[f"{angle}.0"][2]) == pytest.approx(-phi, rel=1e-12)
    share = float(expected["omega2_over_omega0_at_60"])
    assert float(rows["60.0"][3]) == pytest.approx(-share * 3.0 * math.pi, rel=1e-12)


# What is refused ----------------------------------------------------------------------------------


def test_extreme_lengths_and_speeds_give_finite_numbers(capsys: Capture) -> None:
    for frame in ("1e-100", "1e100"):
        for crank in ("1e-100", "1e100"):
            for speed in ("1e-100", "1e100"):
                words = ("--frame", frame, "--crank", crank, "--speed", speed)
                found = document(capsys, *words, "--table", "--from", "1", "--to", "359")
                assert np.all(np.isfinite(np.array(list(found["table"].values()))))


@pytest.mark.parametrize("speed", [0.0, -1.0, math.inf, math.nan, 1e160, 1e-320])
def test_a_speed_without_an_answer_is_refused(speed: float) -> None:
    """1e160 squared, and the time of a turn at 1e-320, are too large for a number."""
    with pytest.raises(GeometryError, match=r"positive number|too large") as refused:
        DrivenLever(SlottedLever(75.0, 150.0), speed)
    assert refused.value.key == "speed"


@pytest.mark.parametrize("swing", [0.0, -60.0, 180.1, math.nan, math.inf])
def test_a_swing_that_cannot_be_is_refused(swing: float) -> None:
    with pytest.raises(GeometryError, match="at most 180") as refused:
        crank_for_swing(150.0, swing)
    assert refused.value.key == "swing"
