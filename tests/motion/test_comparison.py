"""Laws side by side: values, jumps and what is unbounded, against dense samples of each law."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.comparison import QUANTITIES, Entry, Running, compare, entry_of
from camgeo.kinematics.laws.law import Law, characteristic
from camgeo.kinematics.motion import TASKS
from camgeo.units import TURN

GIVEN: dict[str, float] = {"inflection": 0.4, "v0": 0.8, "v1": 1.2, "curved": 0.7}

PLACES = np.linspace(0.0, 1.0, 4001)

BESIDE = 1e-7
"""How far from a border the one-sided values are taken."""


def jumping(law: Law, order: int) -> list[float]:
    """Inner borders at which f' (1) or f'' (2) differs from one side to the other."""
    found = []
    for border in law.borders:
        left, right = law(np.array([border - BESIDE, border + BESIDE]))[order]
        steep = max(float(np.max(np.abs(law(PLACES)[order + 1]))), 1.0)
        if abs(right - left) > 4.0 * BESIDE * steep:
            found.append(border)
    return found


def expected_jumps(law: Law) -> tuple[list[float], list[float]]:
    """Shocks and jerks: what an end of the task has to be and is not, and jumps inside."""
    shocks, jerks = [], []
    for place, kind in ((0.0, law.task[0]), (1.0, law.task[-1])):
        velocity, acceleration = (float(each[0]) for each in law(np.array([place]))[1:3])
        if kind in "RU" and abs(velocity) > 1e-12:
            shocks.append(place)
        if kind in "RG" and abs(acceleration) > 1e-12:
            jerks.append(place)
    return shocks, sorted({*jerks, *jumping(law, 2)})


@pytest.mark.parametrize("task", TASKS)
def test_each_law_for_a_task_is_there_with_what_samples_find(task: str) -> None:
    entries = compare(task, GIVEN)
    assert [each.name for each in entries] == [
        name for name, family in FAMILIES.items() if task in family.tasks
    ]
    for entry in entries:
        taken = FAMILIES[entry.name].parameters[task]
        assert entry.task == task
        assert entry.ignored == tuple(key for key in GIVEN if key not in taken)
        if entry.law is None or entry.values is None:
            assert entry.reason
            continue
        assert entry.reason == ""
        law = entry.law
        assert {key: law.parameters[key] for key in GIVEN if key in taken} == {
            key: value for key, value in GIVEN.items() if key in taken
        }
        shocks, jerks = expected_jumps(law)
        assert entry.shocks == pytest.approx(shocks, abs=1e-12)
        assert entry.jerks == pytest.approx(jerks, abs=1e-12)
        assert_values(entry)
        # Boundary values that it takes, that nobody gave, and that are 0.
        at = {"0": law.start, "1": law.end}
        zero = [
            key
            for key in taken
            if key[1:] in ("0", "1") and key not in GIVEN and entry.name != "polynomial"
            if {"v": at[key[1]].velocity, "a": at[key[1]].acceleration, "j": at[key[1]].jerk}[
                key[0]
            ] == 0.0
        ]  # fmt: skip
        assert list(entry.assumed) == zero
        f = law(PLACES)[0]
        assert entry.overshoots == bool(np.max(f) > 1.0 + 1e-9 or np.min(f) < -1e-9)
        assert entry.runs_back == bool(np.min(law(PLACES)[1]) < -1e-9)


def assert_values(entry: Entry) -> None:
    """They are those of the law, but for what a shock or a jerk of their part makes infinite."""
    law = entry.law
    assert law is not None
    assert entry.values == characteristic(law)
    unbounded = set()
    for places, both in (
        (entry.shocks, (QUANTITIES[1::2], QUANTITIES[2::2])),
        (entry.jerks, (("jerk",), ("braking_jerk",))),
    ):
        for place in places:
            unbounded |= (
                set(both[0]) if law.inflection is None or place <= law.inflection else set()
            )
            unbounded |= (
                set(both[1]) if law.inflection is None or place >= law.inflection else set()
            )
    assert entry.unbounded == unbounded
    for quantity in QUANTITIES:
        value = None if quantity in unbounded else getattr(entry.values, quantity).value
        assert entry.bounded(quantity) == value


def test_only_what_is_asked_for_is_compared_in_its_order() -> None:
    found = compare("R-R", {}, ["scca", "cycloidal", "scca", "simple-sine"])
    assert [each.name for each in found] == ["scca", "inclined-sine", "simple-sine"]
    (refused,) = compare("G-G", {}, ["inclined-sine"])
    assert refused.law is None
    assert refused.values is None
    assert refused.reason == "inclined-sine is made for R-R"
    assert refused.bounded("velocity") is None
    assert not refused.runs_back
    assert not refused.overshoots
    (wrong,) = compare("R-R", {"inflection": 1.5}, ["modified-sine"])
    assert wrong.reason.startswith("inflection = 1.5: ")
    for task, given, names, key in (
        ("R-X", {}, (), "task"),
        ("R-R", {"inflection": math.nan}, (), "inflection"),
        ("R-R", {}, (3,), "names"),
        ("R-R", {}, ("cycloid",), "law"),
    ):
        with pytest.raises(GeometryError) as caught:
            compare(task, given, names)  # type: ignore[arg-type]  # wrong on purpose
        assert caught.value.key == key


@pytest.mark.parametrize("name", ["modified-trapezoid", "polynomial-345"])
def test_physical_values_are_those_of_the_move_in_time(name: str) -> None:
    """By differences of the lift over time, and the torque as power over the cam's speed."""
    speed, span, stroke = 7.5, math.radians(80.0), 22.0
    running = Running(speed, span, stroke)
    law = make_law(name)
    values = {key: getattr(entry_of(law).values, key).value for key in QUANTITIES}
    time = np.linspace(0.0, span / speed, 200_001)
    step = time[1]
    lift = stroke * law(speed * time / span)[0]
    velocity = np.gradient(lift, step)
    acceleration = np.gradient(velocity, step)
    inner = slice(5, -5)
    # 1 kg, mm/s and mm/s^2: 1e-6 W a rad/s.
    torque = 1e-6 * velocity * acceleration / speed
    for quantity, expected, within in (
        ("velocity", np.max(velocity), 1e-4),
        ("acceleration", np.max(acceleration[inner]), 1e-3),
        ("deceleration", np.min(acceleration[inner]), 1e-3),
        ("moment", np.max(torque[inner]), 1e-3),
        ("braking_moment", np.min(torque[inner]), 1e-3),
    ):
        assert running.physical(quantity, values[quantity]) == pytest.approx(expected, rel=within)
    jerk = running.physical("jerk", values["jerk"])
    assert jerk == pytest.approx(values["jerk"] * stroke * (speed / span) ** 3, rel=1e-14)
    assert running.physical("braking_jerk", 2.0) == pytest.approx(
        running.physical("jerk", 2.0), rel=1e-15
    )


def test_a_move_is_at_most_a_turn() -> None:
    assert Running(1.0, TURN, 1.0).span == TURN
    with pytest.raises(GeometryError, match="more than one turn") as caught:
        Running(1.0, TURN * (1.0 + 1e-9), 1.0)
    assert (caught.value.key, caught.value.value) == ("span", "360")
    for name in ("speed", "span", "stroke"):
        with pytest.raises(GeometryError, match="above 0") as caught:
            Running(**({"speed": 1.0, "span": 1.0, "stroke": 1.0} | {name: 0.0}))
        assert caught.value.key == name
