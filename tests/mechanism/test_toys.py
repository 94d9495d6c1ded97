"""A new kind of follower or linkage takes new files and a line of the registry, nothing else."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.copies import check_refused, commands, copied, replaced

FOLLOWER = '''"""Translating follower with a round head, which slides on the cam."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.mechanism.values import Angle, Length
from camgeo.numeric.checked import check_fields, hold


@dataclass(frozen=True)
class Mushroom:
    """The centre of its head moves as that of a roller as large, on a guide through the axis."""

    base_radius: Length
    head_radius: Length
    guide_angle: Angle = math.pi / 2.0

    def __post_init__(self) -> None:
        check_fields(self, "follower.")
        roller = TranslatingRoller(self.base_radius, self.head_radius, 0.0, self.guide_angle)
        hold(self, _centre=roller)

    @property
    def kind(self) -> str:
        return "mushroom"

    @property
    def rolls(self) -> bool:
        return False

    def sliding(self, jet: Any, rotation: int) -> Any:
        at = self._centre.relative_jet(jet, rotation, 1)
        return (at.u * at.u + at.v * at.v) ** 0.5 + self.head_radius

    def __getattr__(self, name: str) -> Any:
        return getattr(object.__getattribute__(self, "_centre"), name)
'''

DECLARED_FOLLOWER = '''"""The mushroom follower, declared."""

from camgeo.record import stored_schema
from camgeo.kinematics.mechanism.values import FollowerKind


def head_is_a_cap(table):
    if table.get("head_radius", 0.0) > 10.0 * table.get("base_radius", 1.0):
        yield "head_radius", "is that of a flat face; use kind = \\"translating-flat\\""


KIND = FollowerKind(
    name="mushroom",
    description="a round head on a straight guide.",
    unit="mm",
    touching="roller",
    schema=stored_schema(__file__),
    class_path="mushroom:Mushroom",
    sizes=("base_radius", "head_radius"),
    rules=(head_is_a_cap,),
)
'''

FOLLOWER_SCHEMA = {
    "title": "a mushroom follower",
    "type": "object",
    "required": ["base_radius", "head_radius"],
    "additionalProperties": False,
    "properties": {
        "base_radius": {"$ref": "#/$defs/base_radius"},
        "head_radius": {"description": "Radius of the head.", "$ref": "#/$defs/length"},
        "guide_angle": {"description": "Direction of the guide.", "$ref": "#/$defs/angle"},
    },
}

TEMPLATE = """# A follower with a round head.
camgeo = 1
name = "mushroom"
[cam]
rotation = "ccw"                 # sense
[follower]
kind = "mushroom"                # a round head
base_radius = 40                 # centre of the head
head_radius = 12                 # of it
[[motion]]
law = "polynomial-345"           # rise
span = 180                       # cam angle
to = 8                           # position
[[motion]]
law = "polynomial-345"
span = 180
to = 0
[limits]
transmission_angle = 45          # smallest
"""

DECLARED_LINKAGE = '''"""A slider-crank of equal crank and coupler, declared: one length."""

import math

from camgeo.record import stored_schema
from camgeo.kinematics.mechanism.values import LinkageKind


def build(values, unit):
    from camgeo.kinematics.mechanism.linkages import SliderCrank

    arm = values.mm * values.table["arm"]
    return SliderCrank(arm, arm, math.radians(30.0), False, 1, 1, 1)


KIND = LinkageKind(
    name="toggle",
    description="the motion is the stroke of a slider that a toggle turns into a swing.",
    members={"rad": "slider"},
    schema=stored_schema(__file__),
    build=build,
)
'''

LINKAGE_SCHEMA = {
    "title": "a toggle",
    "type": "object",
    "required": ["arm"],
    "additionalProperties": False,
    "properties": {"arm": {"description": "Length of both arms.", "$ref": "#/$defs/length"}},
}

LINKED = """camgeo = 1
name = "linked"
[cam]
rotation = "ccw"
[follower]
kind = "oscillating-roller"
pivot = [-90, 20]
arm = 75
base_radius = 60
roller_radius = 10
[linkage]
kind = "toggle"
arm = 60
[[motion]]
law = "polynomial-345"
span = 180
to = 10
[[motion]]
law = "polynomial-345"
span = 180
to = 0
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with both toys: new files, and one that existed."""
    tree = tmp_path_factory.mktemp("toys")
    mechanism = copied(tree) / "kinematics" / "mechanism"
    declared = mechanism / "declared"
    (mechanism / "mushroom.py").write_text(FOLLOWER, encoding="utf-8")
    (declared / "mushroom.py").write_text(DECLARED_FOLLOWER, encoding="utf-8")
    (declared / "mushroom.json").write_text(json.dumps(FOLLOWER_SCHEMA), encoding="utf-8")
    (declared / "toggle.py").write_text(DECLARED_LINKAGE, encoding="utf-8")
    (declared / "toggle.json").write_text(json.dumps(LINKAGE_SCHEMA), encoding="utf-8")
    template = tree / "camgeo" / "scene" / "templates" / "mushroom.toml"
    template.write_text(TEMPLATE, encoding="utf-8")
    replaced(
        declared / "registry.py",
        (
            "\nif TYPE",
            "from camgeo.kinematics.mechanism.declared import mushroom, toggle\n\nif TYPE",
        ),
        ("FOLLOWERS: Final = {\n", "FOLLOWERS: Final = {\n    'mushroom': mushroom.KIND} | {\n"),
        ("LINKAGES: Final = {\n", "LINKAGES: Final = {\n    'toggle': toggle.KIND} | {\n"),
    )
    (tree / "linked.toml").write_text(LINKED, encoding="utf-8")
    return tree


def test_a_new_follower_is_started_checked_built_and_verified(tree: Path) -> None:
    made, checked, built, verified, replayed = commands(
        tree,
        ["new", "mushroom", "-o", "mine.toml"],
        ["check", "mine.toml"],
        ["build", "mine.toml", "--only", "dxf", "-o", "out"],
        ["verify", "out/mushroom.dxf", "--scene", "mine.toml"],
        ["replay", "mine.toml"],
    )
    for code, output, errors in (made, checked, built, verified):
        assert code == 0, output + errors
    assert "smallest transmission angle" in checked[1]
    assert (tree / "out" / "mushroom.dxf").read_bytes().startswith(b"  0\nSECTION")
    assert replayed[0] == 2
    assert 'this one is "mushroom"' in replayed[2]


FAULTS = [
    ("head_radius = 12", "head_radius = -1", "must be a positive number"),
    ("head_radius = 12", "head_radius = 401", "is that of a flat face"),
    ("head_radius", "haed_radius", "did you mean head_radius?"),
    ("head_radius = 12", "head_radius = 12\noffset = 3", "a translating-roller follower"),
    ('"mushroom"  ', '"mushrom"  ', 'did you mean "mushroom"?'),
]


def test_faults_are_reported_as_of_any_follower(tree: Path) -> None:
    check_refused(tree, TEMPLATE, FAULTS)


def test_a_new_linkage_drives_a_rocker_and_no_guided_follower(tree: Path) -> None:
    guided = TEMPLATE.replace("[[motion]]", '[linkage]\nkind = "toggle"\narm = 60\n[[motion]]', 1)
    (tree / "guided.toml").write_text(guided, encoding="utf-8")
    checked, refused = commands(tree, ["check", "linked.toml"], ["check", "guided.toml"])
    assert checked[0] in (0, 1), checked[2]
    assert "coupler" in checked[1]
    assert refused[0] == 2
    assert "a toggle turns a rocker" in refused[2]
