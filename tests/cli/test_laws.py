"""`camgeo laws`: the comparison of motion laws, as table, JSON and picture."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from camgeo.app.answers.laws import laws_of_all_tasks
from camgeo.app.cli.main import main
from camgeo.errors import GeometryError
from camgeo.kinematics.laws.comparison import QUANTITIES, Entry, Running, compare
from camgeo.kinematics.laws.law import Characteristic
from camgeo.kinematics.motion import TASKS
from camgeo.pictures.laws import SAMPLES, figure
from camgeo.pictures.model import Line, Panel, Text

Capture = pytest.CaptureFixture[str]


def records(call: list[str], capsys: Capture) -> dict[str, dict[str, Any]]:
    assert main(["laws", "--json", *call]) == 0
    return {record["law"]: record for record in json.loads(capsys.readouterr().out)["laws"]}


def printed(call: list[str], capsys: Capture) -> str:
    assert main(["laws", *call]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    return captured.out


def row(out: str, name: str) -> list[str]:
    """The cells of a law in the first table."""
    return next(line for line in out.splitlines() if line.startswith(name + " ")).split()


def entry(task: str, name: str, **given: float) -> Entry:
    (found,) = compare(task, given, [name])
    return found


# What is compared ---------------------------------------------------------------------------------


@pytest.mark.parametrize("task", TASKS)
def test_no_number_is_infinite_or_nan(task: str, capsys: Capture) -> None:
    """JSON has no infinity; what is unbounded is null, and is listed."""
    for name, record in records(["--task", task, "--speed", "60", "--span", "90",
                                 "--stroke", "10"], capsys).items():  # fmt: skip
        assert set(record["values"]) == {field.name for field in fields(Characteristic)}, name
        assert set(record["physical"]) == set(QUANTITIES)
        for quantity in QUANTITIES:
            missing = record["values"][quantity] is None
            assert missing == (record["physical"][quantity] is None)
            assert not missing or record["shock_places"] or record["jerk_places"]


@pytest.mark.parametrize("name", ["modified-sine", "polynomial-5", "polynomial-7"])
@pytest.mark.parametrize("v0", [-0.5, 0.5, 6.0])
@pytest.mark.parametrize("v1", [-0.5, 0.5, 6.0])
def test_overshoot_and_running_back_as_sampled(name: str, v0: float, v1: float) -> None:
    """Leaving with a negative velocity, and fast ends that take the move past its goal."""
    found = entry("G-G", name, v0=v0, v1=v1)
    assert found.law is not None
    f, f1, *_ = found.law(np.linspace(0.0, 1.0, 10_001))
    assert found.runs_back == bool(f1.min() < 0.0)
    # Rounding of f: some units in the last place of 1.
    assert found.overshoots == bool(f.min() < -1e-14 or f.max() > 1.0 + 1e-14)
    if min(v0, v1) < 0.0:
        assert found.overshoots


# The table ----------------------------------------------------------------------------------------


def test_the_guideline_s_comparison_from_turn_to_turn(capsys: Capture) -> None:
    """Tafel 3: sine-straight with lambda = 0.5, c = 0.5, and the simple sine with lambda = 0.5."""
    found = records(["--task", "U-U", "--curved", "0.5"], capsys)
    straight, sine = found["sine-straight"]["values"], found["simple-sine"]["values"]
    assert straight["velocity"]["value"] == pytest.approx(2 * math.pi / (math.pi + 2))
    assert sine["velocity"]["value"] == pytest.approx(math.pi / 2)
    assert sine["acceleration"] == {"value": pytest.approx(math.pi**2 / 2), "z": 0.0}
    assert sine["deceleration"] == {"value": pytest.approx(-(math.pi**2) / 2), "z": 1.0}
    # What the guideline says of them: one has the lower C_v, the other the lower C_a.
    assert straight["velocity"]["value"] < sine["velocity"]["value"]
    assert straight["acceleration"]["value"] > sine["acceleration"]["value"]
    assert found["simple-sine"]["ignored"] == ["curved"]
    assert found["sine-straight"]["ignored"] == []
    assert found["polynomial-5"]["assumed_zero"] == ["a0", "a1"]
    # Their accelerations follow from the inflection point; nothing was assumed.
    assert found["sine-straight"]["assumed_zero"] == []


def test_the_guideline_s_comparison_from_rest_to_turn(capsys: Capture) -> None:
    """Tafel 4, lambda = 0.5; C_Mdyn by eqs. (177), (178) and (199), (200), factors of 4 digits."""
    found = records(
        ["--task", "R-U", "--law", "modified-trapezoid", "harmonic-combination"], capsys
    )
    assert list(found) == ["modified-trapezoid", "harmonic-combination"]
    for name, first, second in (
        ("modified-trapezoid", 0.6772, 0.7660),
        ("harmonic-combination", 1.1222 / math.pi, 1.0 / math.pi),
    ):
        values = {key: value["value"] for key, value in found[name]["values"].items()}
        # The factors are printed with 4 decimals: half a unit of the last is 1e-4 of 0.6.
        assert values["moment"] == pytest.approx(
            first * 0.5 * values["acceleration"] ** 2, rel=1e-4
        )
        assert values["braking_moment"] == pytest.approx(
            -second * 0.5 * values["deceleration"] ** 2, rel=1e-4
        )


def test_all_tasks(capsys: Capture) -> None:
    out = printed(["--task", "all"], capsys)
    assert [line.split()[0] for line in out.splitlines()] == list(TASKS)
    assert "rest to turn" in out
    found = laws_of_all_tasks(["cycloidal", "modified-sine"])
    assert [each.task for each in found.tasks or ()] == list(TASKS)
    assert list((found.tasks or ())[0].families) == ["inclined-sine", "modified-sine"]
    with pytest.raises(GeometryError, match="did you mean modified-sine"):
        laws_of_all_tasks(["modified-sin"])


# Physical values ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "numbers"),
    [
        ("speed", (0.0, 1.0, 1.0)),
        ("span", (1.0, -1.0, 1.0)),
        ("span", (1.0, 6.3, 1.0)),
        ("stroke", (1.0, 1.0, math.nan)),
    ],
)
def test_impossible_moves_are_refused(key: str, numbers: tuple[float, float, float]) -> None:
    with pytest.raises(GeometryError) as caught:
        Running(*numbers)
    assert caught.value.key == key


# The picture --------------------------------------------------------------------------------------


def test_every_law_has_its_row_with_all_one_sided_values() -> None:
    entries = compare("U-U", {"a0": 6.0, "a1": -5.0})
    drawn = figure(entries)
    rows = [found for found in entries if found.law is not None]
    assert len(drawn.panels) == 4 * len(rows)
    straight = next(index for index, found in enumerate(rows) if found.name == "sine-straight")
    law = rows[straight].law
    assert law is not None
    jerk = max(lines_in(drawn.panels[4 * straight + 2]), key=lambda line: len(line.points))
    for region in law.regions:
        z = np.array([region.start, region.end])
        for place, value in zip(z, region.values(z)[3], strict=True):
            assert [place, value] in jerk.points.tolist()
    # What cannot be drawn is listed below.
    assert any("simple-sine: not possible" in text.text for text in drawn.texts)


@pytest.mark.parametrize("task", TASKS)
def test_every_law_is_drawn_from_its_start_to_its_end(task: str) -> None:
    for panel in figure(compare(task, {})).panels:
        for line in lines_in(panel):
            z = line.points[:, 0]
            if len(z) >= SAMPLES:
                assert np.all(np.diff(z) >= 0.0)
                assert (z[0], z[-1]) == (0.0, 1.0)


def test_the_picture_marks_extremes_and_what_is_unbounded() -> None:
    velocity, acceleration, jerk, _ = figure([entry("R-R", "quadratic-parabola")]).panels
    dots = [line.points.tolist() for line in lines_in(acceleration) if line.style.marker == "o"]
    assert dots == [[[0.0, 4.0]], [[0.5, -4.0]]]
    assert not [line for line in lines_in(velocity) if line.style.marker == "^"]
    (triangles,) = [line for line in lines_in(jerk) if line.style.marker == "^"]
    assert triangles.points.tolist() == [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]
    assert "C$_j$ unbounded" in [mark.text for mark in jerk.marks if isinstance(mark, Text)]


def lines_in(panel: Panel) -> list[Line]:
    return [mark for mark in panel.marks if isinstance(mark, Line)]


# Wrong calls --------------------------------------------------------------------------------------
