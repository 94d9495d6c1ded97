"""Loads: virtual work against the demanded motion, sides at jumps, and files."""

from __future__ import annotations

import shutil
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import DataFile
from camgeo.dynamics.effects.load import profile_of
from camgeo.dynamics.effects.tables import parse_load as parse
from camgeo.dynamics.effects.tables import read_load_table
from camgeo.errors import GeometryError
from camgeo.kinematics.plan import Dwell, MotionPlan
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import load_scene
from camgeo.units import TURN
from tests.effects.scenes import SCENES, design
from tests.integrals import cells, integrals

PHI = np.linspace(0.0, TURN, 721)


def c0(made: Design, phi: FloatArray = PHI, side: Any = "right") -> FloatArray:
    coefficients = made.effect("load").force.coefficients(phi, side)
    assert not np.any(coefficients[1:])
    found: FloatArray = coefficients[0]
    return found


@pytest.mark.parametrize(
    ("scene", "unit"),
    [("plate_translating", 1.0), ("groove", 1e3), ("setzhub", 1.0), ("schnitt", 1.0)],
)
def test_a_constant_load_works_against_a_positive_motion(scene: str, unit: float) -> None:
    """Virtual work: c0 q' = -F s'; of a rocker it is a torque, behind a linkage a force on the
    slider; and it is there in the rests.
    """
    made = design(scene, "[effects.load]\nconstant = 80\n")
    swing, stroke = made.cam.drive.motion.jet(PHI), made.cam.drive.plan.jet(PHI)
    work = -80.0 * unit * stroke[1]
    assert c0(made) * swing[1] == pytest.approx(work, abs=1e-13 * np.max(np.abs(work)))
    assert np.min(np.abs(c0(made))) > 0.0
    (column,) = made.effect("load").columns
    assert column.unit == ("N" if unit == 1.0 else "N m")
    assert np.array_equal(column.values(PHI, "right"), np.full(721, 80.0))


def test_segments_have_each_their_own() -> None:
    """plate_translating: 30, 100, 40, 120, 70 degrees; the side decides at a joint."""
    made = design("plate_translating", "[effects.load]\nsegments = [1, 2, 3, 4, 5]\n")
    joints = np.radians([0.0, 30.0, 130.0, 170.0, 290.0])
    assert np.array_equal(c0(made, joints), [-1.0, -2.0, -3.0, -4.0, -5.0])
    assert np.array_equal(c0(made, joints, "left"), [-5.0, -1.0, -2.0, -3.0, -4.0])
    assert np.array_equal(c0(made, joints + 0.1), c0(made, joints))
    assert np.array_equal(c0(made, np.array([TURN]), "left"), [-5.0])
    assert np.array_equal(c0(made, np.array([TURN]), "right"), [-1.0])
    result = made.effect("load")
    assert result.force.borders == pytest.approx(joints, abs=1e-15)
    assert [each.value for each in result.findings] == [5.0, 1.0]
    # Work over a turn: 2 N against 20 mm up, 4 N with 20 mm down.
    low, high = cells(made.drive.smooth_angles[:-1], 6)
    work = np.sum(
        integrals(lambda phi: c0(made, phi) * made.cam.drive.motion.jet(phi)[1], low, high)
    )
    assert work == pytest.approx(-2.0 * 20.0 + 4.0 * 20.0, rel=1e-13)


def test_a_rest_of_no_length_has_no_load() -> None:
    """The rest of 40 degrees is cut into 40 and 0."""
    cut = ("dwell = 40\n", "dwell = 40\n\n[[motion]]\ndwell = 0\n")
    made = design("plate_translating", "[effects.load]\nsegments = [1, 2, 3, 4, 5]\n", cut)
    joints = np.radians([0.0, 30.0, 130.0, 170.0, 290.0])
    assert np.array_equal(c0(made, joints), [-1.0, -2.0, -3.0, -4.0, -5.0])
    assert np.array_equal(c0(made, joints, "left"), [-5.0, -1.0, -2.0, -3.0, -4.0])
    still = Dwell(Decimal(0)), Dwell(Decimal(120)), Dwell(Decimal(0)), Dwell(Decimal(240))
    steps = profile_of((7.0, 8.0), MotionPlan(still), "N")
    angles = np.radians([0.0, 120.0])
    assert np.array_equal(steps.values(angles, "right"), [7.0, 8.0])
    assert np.array_equal(steps.values(angles, "left"), [8.0, 7.0])


# Files ----------------------------------------------------------------------------------------

ROWS = "phi [deg];F [N]\n0;10\n90;40\n100;-20\n360;30\n"


def table(text: str) -> Any:
    return read_load_table(DataFile("load.csv", text.encode()))


def test_between_rows_there_are_straight_lines() -> None:
    found = table(ROWS)
    angles = np.radians([0.0, 45.0, 90.0, 95.0, 100.0, 230.0, 360.0])
    expected = [10.0, 25.0, 40.0, 10.0, -20.0, 5.0, 10.0]
    assert found.values(angles, "right") == pytest.approx(expected, abs=1e-12)
    expected[0] = expected[-1] = 30.0  # the value at 360 is not that at 0: it jumps
    assert found.values(angles, "left") == pytest.approx(expected, abs=1e-12)
    assert found.borders == pytest.approx(np.radians([0.0, 90.0, 100.0]), abs=1e-15)
    assert found.values(angles[1:2] + TURN, "right") == pytest.approx([25.0], abs=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1;2\n360;3\n", r"load\.csv, line 1: '1\.0': the first angle; allowed: 0"),
        ("0;2\n350;3\n", r"line 2: '350\.0': the last angle; allowed: 360"),
        ("0;2\n90;1\n90;3\n360;3\n", r"line 3: '90\.0': the angle before is 90\.0"),
        ("0;2\n90;x\n360;3\n", r"line 2: 'x': not a number"),
        ("phi [rad];F\n0;2\n360;3\n", "the unit of the angle; allowed: deg"),
        ("phi;F [kg]\n0;2\n360;3\n", "the unit of the load; allowed: N or Nm"),
    ],
)
def test_a_wrong_row_is_reported_with_its_line(text: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        parse({"file": DataFile("load.csv", text.encode())})
    assert caught.value.key == "file"


def scene_with(folder: Path, rows: str, scene: str = "plate_translating") -> Design:
    shutil.copy(SCENES / f"{scene}.toml", folder / "cam.toml")
    (folder / "load.csv").write_text(rows, "utf-8")
    with (folder / "cam.toml").open("a", encoding="utf-8") as file:
        file.write('\n[effects.load]\nfile = "load.csv"\n')
    return Design(load_scene(folder / "cam.toml"))


def test_a_file_of_a_scene_gives_the_force(tmp_path: Path) -> None:
    made = scene_with(tmp_path, ROWS)
    angles = np.radians([0.0, 45.0, 95.0])
    assert c0(made, angles) == pytest.approx([-10.0, -25.0, -10.0], abs=1e-12)
    assert c0(made, angles[:1], "left") == pytest.approx([-30.0], abs=1e-12)
    largest, smallest = made.effect("load").findings
    assert (largest.value, smallest.value) == (40.0, -20.0)
    assert largest.cam_angle == pytest.approx(np.radians(90.0), rel=1e-15)


def test_a_heading_in_another_unit_is_refused(tmp_path: Path) -> None:
    made = scene_with(tmp_path, "phi,M [Nm]\n0,1\n360,1\n")
    with pytest.raises(GeometryError, match="loads in N m") as caught:
        made.effect("load")
    assert caught.value.key == "effects.load.file"


def test_a_file_of_torques_loads_a_rocker(tmp_path: Path) -> None:
    made = scene_with(tmp_path, "angle,torque [N m]\n0,1\n360,2\n", "groove")
    assert c0(made, np.array([np.pi])) == pytest.approx([-1500.0], rel=1e-14)


# What has no answer ---------------------------------------------------------------------------
