"""`camgeo laws`: the comparison of motion laws, as table, JSON and picture."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from camgeo.app.answers.laws import HEAD, PHYSICAL_HEAD, UNITS, laws_of_all_tasks
from camgeo.app.cli.main import main
from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.comparison import QUANTITIES, Entry, Running, compare
from camgeo.kinematics.laws.law import Characteristic
from camgeo.kinematics.motion import TASKS
from camgeo.pictures.laws import SAMPLES, figure
from camgeo.pictures.model import Line, Panel, Text
from camgeo_export.plots import render

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
def test_every_family_of_a_task_is_listed(task: str) -> None:
    made = [name for name, family in FAMILIES.items() if task in family.tasks]
    entries = compare(task, {})
    assert [found.name for found in entries] == made
    assert all(found.reason == "" for found in entries), entries


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


# VDI 2143-1, Tafel 2: two shocks of the straight line, three jerks of the parabola, two of the
# simple sine; the others are free of jerks.
@pytest.mark.parametrize(
    ("name", "shocks", "jerks", "unbounded"),
    [
        ("straight-line", (0.0, 1.0), (), set(QUANTITIES[1:])),
        ("quadratic-parabola", (), (0.0, 0.4, 1.0), {"jerk", "braking_jerk"}),
        ("simple-sine", (), (0.0, 1.0), {"jerk", "braking_jerk"}),
        ("polynomial-345", (), (), set()),
        ("inclined-sine", (), (), set()),
        ("modified-trapezoid", (), (), set()),
        ("modified-sine", (), (), set()),
    ],
)
def test_shocks_and_jerks_from_rest_to_rest(
    name: str, shocks: tuple[float, ...], jerks: tuple[float, ...], unbounded: set[str]
) -> None:
    found = entry("R-R", name, inflection=0.4)
    assert found.shocks == shocks
    assert found.jerks == pytest.approx(jerks)
    assert found.unbounded == unbounded


def test_a_turn_is_no_jerk_where_the_task_turns() -> None:
    """The simple sine starts with f'' = pi^2/2: a jerk from rest, none from a turn."""
    assert entry("U-U", "simple-sine").jerks == ()
    assert entry("U-U", "simple-sine").unbounded == set()
    for task in ("R-U", "U-R"):
        assert entry(task, "harmonic-combination").jerks == ()


def test_what_the_task_leaves_open_is_no_jerk() -> None:
    """The free polynomial: f'' is not zero at either end, and the task B-B wants nothing of it."""
    found = entry("B-B", "polynomial", v0=-1.0)
    assert found.jerks == ()
    # f = -z + 2 z^2.
    assert found.bounded("acceleration") == pytest.approx(4.0)
    assert found.runs_back
    assert found.overshoots
    assert not entry("B-B", "polynomial", v0=1.5).runs_back


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


def test_jerk_in_one_part_leaves_the_other_its_value() -> None:
    """A law that starts with a jump of f'' at z = 0 only has a bounded jerk behind its middle."""
    from camgeo.kinematics.laws.comparison import _unbounded

    law = make_law("modified-sine")
    assert _unbounded(law, (), (0.0,)) == {"jerk"}
    assert _unbounded(law, (), (1.0,)) == {"braking_jerk"}
    assert _unbounded(law, (), (0.5,)) == {"jerk", "braking_jerk"}
    assert _unbounded(law, (0.0,), ()) == {"acceleration", "jerk", "moment"}
    # A polynomial has no parts: its values are those of the whole move.
    assert _unbounded(make_law("polynomial-5"), (), (0.0,)) == {"jerk", "braking_jerk"}


# The table ----------------------------------------------------------------------------------------


def test_rest_to_rest_is_the_default(capsys: Capture) -> None:
    out = printed([], capsys)
    assert out == printed(["--task", "R-R"], capsys)
    # f' = 30 z^2 (1 - z)^2: C_v = 15/8, C_a = 10/sqrt(3), C_j = 60, C_Mdyn = 6075/(343 sqrt(7)).
    cells = row(out, "polynomial-345")
    assert cells[1:] == ["lambda=0.5", "1.87500", "5.77350", "-5.77350", "60.00000", "60.00000",
                         "6.69427", "-6.69427"]  # fmt: skip
    assert row(out, "quadratic-parabola")[5:7] == ["unbounded", "unbounded"]
    assert "jerk at z = 0, 0.5, 1" in out
    assert "shock at z = 0, 1" in out
    assert "cycloidal is inclined-sine" in out
    assert all(name in out.splitlines()[0].split() for name in HEAD)


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


def test_what_cannot_be_is_listed_with_its_reason(capsys: Capture) -> None:
    """A simple sine has one parameter, so that only one of its turns can be chosen."""
    call = ["--task", "U-U", "--a0", "6", "--a1", "-5"]
    out = printed(call, capsys)
    (line,) = [line for line in out.splitlines() if line.startswith("simple-sine ")]
    assert "not possible: a0 = 6.0: a0 and a1 each decide" in line
    assert row(out, "sine-straight")[1].startswith("lambda=")
    record = records(call, capsys)["simple-sine"]
    assert record["values"] is None
    assert record["reason"].startswith("a0 = 6.0: ")
    move = ["--speed", "60", "--span", "60", "--stroke", "5"]
    (line,) = [line for line in printed([*call, *move], capsys).splitlines() if "simple-si" in line]
    assert "not possible" in line  # and no physical values
    out = printed(["--task", "G-U", "--law", "straight-line", "polynomial-5"], capsys)
    assert "not possible: straight-line is made for R-R, G-G" in out


@pytest.mark.parametrize(
    ("call", "reasons"),
    [
        (["--law", "simple-sine", "--inflection", "0"],
         ["simple-sine: not possible: inflection = 0.0: the inflection point must lie strictly"]),
        (["--law", "scca", "simple-sine", "--inflection", "0"],
         ["scca, simple-sine: not possible: inflection = 0.0: "]),
        (["--task", "G-U", "--law", "straight-line"],
         ["straight-line: not possible: straight-line is made for R-R, G-G"]),
    ],
)  # fmt: skip
def test_if_no_law_is_possible_the_call_is_refused(
    call: list[str], reasons: list[str], capsys: Capture
) -> None:
    assert main(["laws", *call]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    _, *lines = err.splitlines()
    assert all(reason in line for reason, line in zip(reasons, lines, strict=True))
    assert main(["laws", *call, "--json"]) == 2
    assert len(json.loads(capsys.readouterr().out)["faults"]) == len(reasons)


def test_places(capsys: Capture) -> None:
    plain = printed(["--law", "inclined-sine"], capsys).splitlines()
    lines = printed(["--law", "inclined-sine", "--places"], capsys).splitlines()
    assert [line for line in lines if line not in plain] == [lines[2]]
    # f' = 1 - cos(2 pi z): C_v in the middle, C_a at the quarters, C_j at the ends, C_Mdyn at 1/3.
    assert lines[2].split() == ["at", "z", "0.50000", "0.25000", "0.75000", "0.00000", "1.00000",
                                "0.33333", "0.66667"]  # fmt: skip


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


def test_physical_values_by_units_and_by_simulation(capsys: Capture) -> None:
    """25 mm in 60 degrees at 120 rev/min: the move takes 1/12 s.

    The torque from the power that accelerates 1 kg: M omega = m a v, in SI units.
    """
    seconds = 60.0 / 360.0 / 2.0
    omega = 4.0 * math.pi
    call = ["--law", "modified-sine", "--speed", "120", "--span", "60", "--stroke", "25"]
    record = records(call, capsys)["modified-sine"]
    values, physical = record["values"], record["physical"]
    for quantity, order in (("velocity", 1), ("acceleration", 2), ("jerk", 3)):
        expected = values[quantity]["value"] * 25.0 / seconds**order
        assert physical[quantity]["value"] == pytest.approx(expected, rel=1e-12)
    # f' f'' sampled: near its extreme its error is of second order, (1e-5 2 pi)^2 or 4e-9 at most
    # of a few times the value.
    _, f1, f2, _ = make_law("modified-sine")(np.linspace(0.0, 1.0, 100_001))
    power = (f1 * 0.025 / seconds) * (f2 * 0.025 / seconds**2)
    assert physical["moment"]["value"] == pytest.approx(power.max() / omega, rel=1e-7)
    assert physical["braking_moment"]["value"] == pytest.approx(power.min() / omega, rel=1e-7)
    assert [physical[quantity]["unit"] for quantity in QUANTITIES] == list(UNITS)
    out = printed(call, capsys)
    assert "120 rev/min, 60 degrees, stroke 25 mm" in out
    heading = next(line for line in out.splitlines() if "M/m*" in line)
    assert heading.split() == ["law", *PHYSICAL_HEAD]
    last = [line for line in out.splitlines() if line.startswith("modified-sine ")][-1]
    assert float(last.split()[1]) == pytest.approx(physical["velocity"]["value"], rel=1e-4)


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


def test_no_such_kind_of_picture() -> None:
    with pytest.raises(ValueError, match=r"\.svg, \.png and \.pdf"):
        render(figure(compare("R-R", {})), ".gif")


# Wrong calls --------------------------------------------------------------------------------------


def test_a_name_may_be_an_alias_and_is_listed_once(capsys: Capture) -> None:
    found = records(["--law", "cycloidal", "inclined-sine", "modified-sine"], capsys)
    assert list(found) == ["inclined-sine", "modified-sine"]
