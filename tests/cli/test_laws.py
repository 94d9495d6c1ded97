"""`camgeo laws`: the comparison of motion laws, as table, JSON and picture."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from camgeo.app.cli.main import main
from camgeo.errors import GeometryError
from camgeo.kinematics.laws.comparison import QUANTITIES, Running, compare
from camgeo.kinematics.laws.law import Characteristic
from camgeo.kinematics.motion import TASKS
from camgeo.pictures.laws import SAMPLES, figure
from camgeo.pictures.model import Line, Panel

Capture = pytest.CaptureFixture[str]


def records(call: list[str], capsys: Capture) -> dict[str, dict[str, Any]]:
    assert main(["laws", "--json", *call]) == 0
    return {record["law"]: record for record in json.loads(capsys.readouterr().out)["laws"]}


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
    (found,) = compare("G-G", {"v0": v0, "v1": v1}, [name])
    assert found.law is not None
    f, f1, *_ = found.law(np.linspace(0.0, 1.0, 10_001))
    # Rounding of f: some units in the last place of 1.
    outside = bool(f.min() < -1e-14 or f.max() > 1.0 + 1e-14)
    assert (found.overshoots, found.runs_back) == (outside, bool(f1.min() < 0.0))


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


@pytest.mark.parametrize("task", TASKS)
def test_every_law_is_drawn_from_its_start_to_its_end(task: str) -> None:
    for panel in figure(compare(task, {})).panels:
        for line in lines_in(panel):
            z = line.points[:, 0]
            if len(z) >= SAMPLES:
                assert np.all(np.diff(z) >= 0.0)
                assert (z[0], z[-1]) == (0.0, 1.0)


def lines_in(panel: Panel) -> list[Line]:
    return [mark for mark in panel.marks if isinstance(mark, Line)]
