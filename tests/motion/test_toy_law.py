"""A law in one new file and one line is known to the scene, the commands, `auto` and pickles."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.copies import check_page, check_refused, commands, copied, replaced, run_copy

TOY = '''"""Septic from rest to rest with a part of the 3-4-5 polynomial's jerk at the ends."""

from camgeo.kinematics.laws.family import Family, Option
from camgeo.kinematics.laws.polynomials import law_of_boundary_values

SMOOTH = Option(
    name="smooth",
    symbol="s",
    text="part of the jerk at the ends that is taken away",
    schema={"type": "number", "minimum": 0, "maximum": 1},
    default=0.4,
)


def make(task, given):
    jerk = 60.0 * (1.0 - given.get("smooth", SMOOTH.default))
    rest = {key: 0.0 for key in ("v0", "a0", "v1", "a1")}
    return law_of_boundary_values("toy-septic", task, {**rest, "j0": jerk, "j1": jerk}, given)


FAMILY = Family("toy-septic", {"R-R": ("smooth",)}, make, options=(SMOOTH,), aliases=("toy",))
'''

TEXT = """A septic whose jerk at the ends is chosen.

<!-- picture -->

**Use** in tests. **Not** elsewhere.

<!-- values -->
"""

DOCS = Path(__file__).resolve().parents[2] / "docs"

LINE = '    "polynomial-345",\n'
"""Line of the registry after which that of the toy law is added."""

SCENE = """camgeo = 1
name = "toy"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10
[[motion]]
dwell = 60
[[motion]]
law = "toy-septic"
smooth = 0.25
span = 120
to = 12
[[motion]]
law = "toy"
span = 180
to = 0
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package and of docs with the toy law, and a scene that names it."""
    tree = tmp_path_factory.mktemp("toy")
    shutil.copytree(DOCS, tree / "docs")
    shutil.copytree(DOCS.parent / "fixtures" / "tables", tree / "fixtures" / "tables")
    (tree / "docs" / "laws" / "toy-septic.md").write_text(TEXT, encoding="utf-8")
    laws = copied(tree) / "kinematics" / "laws"
    (laws / "toy_septic.py").write_text(TOY, encoding="utf-8")
    replaced(laws / "__init__.py", (LINE, f'{LINE}    "toy-septic",\n'))
    (tree / "toy.toml").write_text(SCENE, encoding="utf-8")
    return tree


def test_a_scene_takes_it_and_its_parameter(tree: Path) -> None:
    checked, table = commands(tree, ["check", "toy.toml"], ["table", "toy.toml", "--step", "30"])
    assert (checked[0], checked[2]) == (0, "")
    assert table[0] == 0, table[2]
    rows = [[float(cell) for cell in line.split(",")[:2]] for line in table[1].splitlines()[1:]]
    assert [row[1] for row in rows if row[0] in (60.0, 120.0, 180.0, 270.0)] == pytest.approx(
        [0.0, 6.0, 12.0, 6.0]
    )


FAULTS = [
    ('"toy-septic"', '"toy-sceptic"', 'did you mean "toy-septic"?'),
    ("smooth =", "smoth =", "did you mean smooth?"),
    ("0.25", "1.5", "must be a number from 0 to 1"),
    ('"toy-septic"', '"polynomial-345"', 'is not a parameter of "polynomial-345"'),
    ("smooth =", "curved =", 'is not a parameter of "toy-septic"; its parameters: smooth'),
]


def test_faults_are_reported_as_of_any_law(tree: Path) -> None:
    check_refused(tree, SCENE, FAULTS)


def test_the_command_of_laws_lists_and_makes_it(tree: Path) -> None:
    made, listed, helped = commands(
        tree, ["laws", "--law", "toy", "--smooth", "1", "--json"], ["laws"], ["laws", "--help"]
    )
    (found,) = json.loads(made[1])["laws"]
    assert found["law"] == "toy-septic"
    assert found["parameters"] == {"smooth": 1.0}
    assert found["values"]["acceleration"]["value"] == pytest.approx(7.5132, abs=1e-4)  # 4-5-6-7
    assert "toy-septic" in listed[1]
    assert "--smooth S" in helped[1]


def test_auto_picks_it_and_its_plan_travels(tree: Path) -> None:
    """Two fifths of the jerk taken from the ends leave less jerk than any other law has."""
    script = """
import pickle, numpy as np
from decimal import Decimal
from camgeo.kinematics.plan import Dwell
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import MoveRequest
from camgeo.scene.schema import schema
asked = [MoveRequest(Decimal(span), to, "auto", optimise={"jerk": 1.0})
         for span, to in ((120, 12.0), (180, 0.0))]
plan = plan_motion([Dwell(Decimal(30)), asked[0], Dwell(Decimal(30)), asked[1]])
print(plan.segments[1].law.name)
phi = np.linspace(0.0, 6.0, 99)
print(np.array_equal(pickle.loads(pickle.dumps(plan)).jet(phi), plan.jet(phi)))
print(schema()["$defs"]["move"]["properties"]["smooth"]["description"])
"""
    done = run_copy(tree, "-c", script)
    assert done.stdout.splitlines() == [
        "toy-septic",
        "True",
        's: part of the jerk at the ends that is taken away; for "toy-septic" (default 0.4).',
    ], done.stderr


def test_pages_are_made_with_it(tree: Path) -> None:
    check_page(tree, "laws", "images/laws/toy-septic.svg)")
    check_page(tree, "scene", 'for "toy-septic" (default 0.4)')
