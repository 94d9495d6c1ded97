"""Segments of a scene that ask for more than a law from rest to rest."""

from __future__ import annotations

import errno
import hashlib
import math
import os
from pathlib import Path

import numpy as np
import pytest

from camgeo.kinematics.plan import MotionPlan, Move, SplineMove
from camgeo.scene.scene import load_scene, parse_scene
from tests.findings import known
from tests.scene.scenes import refusal_by, refusal_of

HEAD = """camgeo = 1
name = "motion"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 60
roller_radius = 8
"""

ROCKER = HEAD.replace(
    'kind = "translating-roller"', 'kind = "oscillating-roller"\npivot = [110, 0]\narm = 90'
)

ROWS = "angle [deg],lift [mm]\n" + "".join(
    f"{k},{10.0 * (1.0 - math.cos(math.radians(k))):.9f}\n" for k in range(0, 360, 5)
)


def plan_of(motion: str, head: str = HEAD) -> MotionPlan:
    return parse_scene(head + motion).plan


def faults_of(motion: str, head: str = HEAD, file: str = "") -> list[str]:
    return [str(fault) for fault in refusal_of(head + motion, file).faults]


def law_of(plan: MotionPlan, number: int) -> Move:
    segment = plan.segments[number]
    assert isinstance(segment, Move)
    return segment


def test_stated_values_are_those_at_the_joint_in_engine_units() -> None:
    motion = """
[[motion]]
dwell = 60
[[motion]]
law = "polynomial-7"
span = 120
to = 10
velocity = 3
acceleration = -2
jerk = 5
[[motion]]
law = "polynomial-5"
span = 180
to = 0
"""
    for head, unit in ((HEAD, 1.0), (ROCKER, math.radians(1.0))):
        plan = plan_of(motion, head)
        at = plan.jet(np.array([math.pi]), "left")[:, 0]
        assert at == pytest.approx(unit * np.array([10.0, 3.0, -2.0, 5.0]), rel=1e-12)
    inches = plan_of(motion, HEAD.replace("[cam]", '[units]\nlength = "inch"\n[cam]'))
    at = inches.jet(np.array([math.pi]), "left")[:, 0]
    assert at == pytest.approx(25.4 * np.array([10.0, 3.0, -2.0, 5.0]), rel=1e-12)


def test_words_for_the_inflection_and_the_shape_of_a_law() -> None:
    plan = plan_of("""
[[motion]]
dwell = 60
[[motion]]
law = "modified-trapezoid"
span = 60
to = 10
inflection = "equal-jerk"
[[motion]]
law = "harmonic-combination"
span = 120
to = 0
[[motion]]
dwell = 20
[[motion]]
law = "scca"
span = 60
to = 5
sine = 0.3
cosine = 0.5
curved = 0.8
inflection = 0.45
[[motion]]
law = "cycloidal"
span = 40
to = 0
""")
    assert law_of(plan, 1).law.parameters["inflection"] == pytest.approx(0.513156266902126)
    assert law_of(plan, 2).law.task == "U-R"
    assert law_of(plan, 4).law.parameters == {
        "inflection": 0.45, "sine": 0.3, "cosine": 0.5, "curved": 0.8,
    }  # fmt: skip
    assert law_of(plan, 5).law.name == "inclined-sine"


@pytest.mark.parametrize(
    ("optimise", "law"),
    [
        ("", "modified-trapezoid"),
        ('optimise = "jerk"', "inclined-sine"),
        ("optimise = { velocity = 1, acceleration = 1e-6 }", "modified-sine"),
    ],
)
def test_auto_and_what_it_optimises(optimise: str, law: str) -> None:
    plan = plan_of(f"""
[[motion]]
dwell = 60
[[motion]]
law = "auto"
span = 120
to = 10
{optimise}
[[motion]]
dwell = 60
[[motion]]
law = "polynomial-345"
span = 120
to = 0
""")
    assert law_of(plan, 1).law.name == law


def test_points() -> None:
    plan = plan_of("""
[[motion]]
dwell = 60
[[motion]]
law = "points"
span = 120
to = 10
points = [
  { at = 30, to = 1.5 },
  { at = 90, to = 9, velocity = 2, acceleration = -1 },
]
[[motion]]
dwell = 60
[[motion]]
law = "auto"
span = 120
to = 0
""")
    at = plan.jet(np.radians([90.0, 150.0]))
    assert at[0] == pytest.approx([1.5, 9.0], rel=1e-12)
    assert at[1:3, 1] == pytest.approx([2.0, -1.0], rel=1e-11)


def with_table(folder: Path, rows: str, extra: str = "", span: int = 360) -> Path:
    (folder / "lift.csv").write_text(rows, encoding="utf-8")
    rest = f"[[motion]]\ndwell = {360 - span}\n" if span < 360 else ""
    motion = f'{rest}[[motion]]\nlaw = "table"\nspan = {span}\nfile = "lift.csv"\n{extra}'
    scene = folder / "scene.toml"
    scene.write_text(HEAD + motion, encoding="utf-8")
    return scene


def test_a_table_in_the_folder_of_the_scene(tmp_path: Path) -> None:
    scene = load_scene(with_table(tmp_path, ROWS, "smoothing = 0.001\n"))
    (move,) = scene.plan.segments
    assert isinstance(move, SplineMove)
    assert known(move.report).largest_deviation <= 1e-3
    digest = hashlib.sha256((tmp_path / "lift.csv").read_bytes()).hexdigest()
    assert scene.files == (("lift.csv", digest),)
    lift = scene.plan.jet(np.array([math.pi]))[0, 0]
    assert lift == pytest.approx(20.0, abs=2e-3)


def test_a_table_over_a_part_of_the_turn(tmp_path: Path) -> None:
    rows = "0;0\n60;8,5\n120;8,5\n180;0\n"
    scene = load_scene(with_table(tmp_path, rows, span=180))
    plan = scene.plan
    assert plan.jet(np.radians([180.0, 240.0, 300.0]))[0] == pytest.approx([0.0, 8.5, 8.5])
    ends = plan.jet(np.array([math.pi]))
    assert ends[1:3, 0] == pytest.approx([0.0, 0.0], abs=1e-9), "its neighbour rests"


@pytest.mark.parametrize(
    ("rows", "extra", "message"),
    [
        (ROWS.replace("[mm]", "[inch]"), "", "states the lift in inch; the scene expects it in mm"),
        (
            ROWS.replace("\n20,", "\n12,"),
            "",
            "lift.csv, line 6: '12.0': the angle does not exceed the one before, 15.0",
        ),
        (ROWS, "smoothing = 0", "motion[1].smoothing = 0: must be a positive number"),
        (ROWS, "to = 3", "motion[1].to = 3: belongs to a move; this is a move by a lift table"),
        (ROWS + "360,1\n", "", "motion[1].file"),
        ("0,0\n100,1e200\n200,6\n360,0\n", "", "lift.csv, line 2: '1e200': too large"),
    ],
)
def test_faults_of_a_table(tmp_path: Path, rows: str, extra: str, message: str) -> None:
    caught = refusal_by(load_scene, with_table(tmp_path, rows, extra))
    assert any(message in str(fault) for fault in caught.faults), str(caught)
    assert all(fault.line is not None for fault in caught.faults)


TABLE = '[[motion]]\nlaw = "table"\nspan = 360\nfile = "{}"\n'


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing.csv", f"cannot be read: {os.strerror(errno.ENOENT)}"),
        ("../lift.csv", "must not leave the folder of the scene"),
        ("/etc/passwd", "must not leave the folder of the scene"),
        ("a\\u0000b", "must be the name of a file"),
    ],
)
def test_files_that_are_not_there(tmp_path: Path, name: str, message: str) -> None:
    (fault,) = faults_of(TABLE.format(name), file=str(tmp_path / "scene.toml"))
    assert message in fault
    assert "line 12: motion[1].file" in fault


MOVE = "[[motion]]\ndwell = 60\n[[motion]]\nspan = 120\nto = 10\n{}\n"
BACK = '[[motion]]\ndwell = 60\n[[motion]]\nlaw = "auto"\nspan = 120\nto = 0\n'


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            'law = "modified-sine"\ncurved = 0.5',
            'curved = 0.5: is not a parameter of "modified-sine"',
        ),
        ('law = "polynomial-5"\ninflection = 0.4', "it has no parameters"),
        ('law = "modified-sine"\noptimise = "jerk"', 'belongs to law "auto"'),
        ('law = "auto"\noptimise = "speed"', "must be one of"),
        ('law = "auto"\noptimise = { jerk = 0 }', "optimise"),
        ('law = "auto"\njerk = 3', 'jerk = 3: is not a parameter of "auto"'),
        ('law = "modified-sine"\ninflection = "middle"', 'be one of "equal-acceleration"'),
        ('law = "scca"\nsine = 0.6\ncosine = 0.6', "add up to more than 1"),
        ('law = "polynomial-5"\nvelocity = 3', "must be 0 at the end of a move that meets a rest"),
        ('law = "sine-straight"', "here the move goes from rest to rest (R-R)"),
        ('law = "points"', "points: is missing"),
        ('law = "points"\npoints = []', "points"),
        (
            'law = "points"\npoints = [{ at = 130, to = 3 }]',
            "must ascend and be less than the span",
        ),
        ('law = "points"\npoints = [{ at = 30, to = 3 }, { at = 30, to = 4 }]', "must ascend"),
        ('law = "points"\npoints = [{ at = 30, t = 3 }]', "did you mean to?"),
        ('law = "points"\npoints = [{ at = 30, to = 3 }]\nsmoothing = 1', "belongs to"),
    ],
)
def test_faults_of_a_move(keys: str, message: str) -> None:
    faults = faults_of(MOVE.format(keys) + BACK)
    assert any(message in fault for fault in faults), faults
    assert all("motion[2]" in fault for fault in faults), faults
    assert all(fault.startswith("line ") for fault in faults), faults


def test_a_dwell_has_no_velocity() -> None:
    faults = faults_of("[[motion]]\ndwell = 360\nvelocity = 0\n")
    assert any("motion[1].velocity = 0: belongs to a move" in fault for fault in faults), faults


SPEED = "time,angle\n0,0\n0.1,30\n0.2,100\n0.3,180\n0.4,260\n0.5,360\n"


def with_speeds(folder: Path, rows: str, keys: str = "") -> Path:
    (folder / "speed.csv").write_text(rows)
    scene = folder / "scene.toml"
    head = HEAD.replace('"ccw"\n', f'"ccw"\n{keys}speed_curve = "speed.csv"\n')
    scene.write_text(head + "[[motion]]\ndwell = 360\n")
    return scene


def test_a_speed_curve(tmp_path: Path) -> None:
    found = load_scene(with_speeds(tmp_path, SPEED))
    assert found.speed == pytest.approx(2.0 * math.pi / 0.5, rel=1e-14)
    assert known(found.speed_curve).time(np.radians([100.0])) == pytest.approx([0.2])
    assert [name for name, _ in found.files] == ["speed.csv"]


@pytest.mark.parametrize(
    ("rows", "keys", "message"),
    [
        (SPEED, "speed = 60\n", "contradicts speed; state only one of them"),
        (
            SPEED.replace("260", "160"),
            "",
            "line 6: '160.0': the angle does not exceed the one before, 180",
        ),
        ("0,0\n0.1,180\n0.5,360\n", "", "speed.csv: 3 rows; allowed: 4 rows or more"),
        ("0,0\n0.2,100\n0.21,300\n0.8,310\n1,360\n", "",
         ".csv: the cam would stand still or run backwards between the rows: -2513.67 rev/min"),
        ("0,0\n1e300,90\n2e300,180\n3e300,360\n", "",
         "speed.csv, line 2: '1e300': too large; allowed: numbers up to 1e+30"),
    ],
)  # fmt: skip
def test_a_speed_curve_s_faults_are_of_its_file(
    tmp_path: Path, rows: str, keys: str, message: str
) -> None:
    (fault,) = refusal_by(load_scene, with_speeds(tmp_path, rows, keys)).faults
    assert (fault.key, fault.value) == ("cam.speed_curve", '"speed.csv"')
    assert message in fault.message
