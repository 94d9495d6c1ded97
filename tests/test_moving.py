"""A scene without a follower: a motion, its table and picture, and refusals of all else."""

from __future__ import annotations

import json
import math
import pathlib
from decimal import Decimal
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.app.cli.main import main
from camgeo.check.judge import motion_findings
from camgeo.errors import SceneError
from camgeo.scene.scene import Scene
from tests.findings import effect_findings

SCENES = pathlib.Path(__file__).parents[1] / "fixtures" / "scenes"

PHI = np.linspace(0.0, 2.0 * math.pi, 73)

FREE = """\
camgeo = 1
name = "free"
[cam]
rotation = "ccw"
speed = 60
[[motion]]
law = "modified-sine"
span = 150
to = 20
[[motion]]
dwell = 30
[[motion]]
law = "polynomial-345"
span = 180
to = 0
[effects.kinematics]
"""


def without_follower(name: str) -> tuple[camgeo.Design, camgeo.Design]:
    """A design, and the same without what its disc needs."""
    design = camgeo.load(SCENES / f"{name}.toml")
    edits: dict[str, Any] = {"follower": None, "effects": None, "part": None, "output": None}
    edits["limits"] = None
    if design.scene.lift_unit == "rad" and design.scene.linkage is None:
        edits["units.motion"] = "degrees"
    return design, camgeo.Design(design.scene.with_values(edits))


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "four_bar", "inch", "knife_edge"])
def test_the_motion_is_that_with_a_follower(name: str) -> None:
    design, free = without_follower(name)
    assert free.scene.follower is None
    assert free.scene.lift_unit == design.scene.lift_unit
    assert free.drive.unit == design.drive.unit
    for side in ("left", "right"):
        assert free.drive.plan.jet(PHI, side).tolist() == design.drive.plan.jet(PHI, side).tolist()
        assert (
            free.drive.motion.jet(PHI, side).tolist() == design.drive.motion.jet(PHI, side).tolist()
        )
    table, whole = free.tabulated.table(), design.tabulated.table(Decimal(1))
    assert table.names == whole.names[: len(table.names)]
    assert table.values.tolist() == whole.values[:, : len(table.names)].tolist()


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "four_bar"])
def test_the_motion_is_judged_without_a_disc(name: str) -> None:
    design, free = without_follower(name)
    alone = set(free.findings)
    assert alone < set(design.findings)
    assert {each.name for each in motion_findings(design.drive)} <= {each.name for each in alone}
    assert any(each.name == "dead-centre" for each in alone) == (design.scene.linkage is not None)
    assert free.judgement.cures == ()


def test_degrees_are_stated() -> None:
    lengths = camgeo.loads(FREE)
    degrees = camgeo.Design(lengths.scene.with_values({"units.motion": "degrees"}))
    assert lengths.drive.unit == "mm"
    assert degrees.drive.unit == "rad"
    assert float(lengths.drive.plan.jet(PHI)[0].max()) == 20.0
    assert float(degrees.drive.plan.jet(PHI)[0].max()) == math.radians(20.0)
    assert degrees.scene.made != lengths.scene.made
    assert "psi [deg]" in degrees.tabulated.table().names


@pytest.mark.parametrize(
    ("text", "key", "message"),
    [
        ('[units]\nmotion = "turns"\n', "units.motion", "must be one of"),
        (
            '[units]\nmotion = "degrees"\n[linkage]\nkind = "four-bar"\n',
            "units.motion",
            r"belongs to a scene without \[linkage\]",
        ),
        ("[effects.inertia]\nmass = 2\n", "effects.inertia", r"needs \[follower\]"),
        ("[folower]\n", "folower", "did you mean follower"),
    ],
)
def test_faults(text: str, key: str, message: str) -> None:
    with pytest.raises(SceneError, match=message) as caught:
        camgeo.loads(FREE + text)
    assert key in {fault.key for fault in caught.value.faults}


def test_kinematics_need_no_follower() -> None:
    design = camgeo.loads(FREE)
    findings = {each.name: each for each in effect_findings(design)}
    # The modified sine's largest velocity and acceleration as parts of the stroke by the span, VDI
    # 2143-1, at one turn a second.
    assert findings["highest-velocity"].value == pytest.approx(1.76 * 20 / (150 / 360), rel=1e-3)
    assert findings["turn-time"].value == pytest.approx(1.0)
    assert "velocity [mm/s]" in design.tabulated.table().names


@pytest.mark.parametrize("ask", ["cams", "cam", "discs", "disc"])
def test_what_needs_a_disc_says_so(ask: str) -> None:
    with pytest.raises(SceneError, match="follower: is missing: a disc needs it") as caught:
        getattr(camgeo.loads(FREE), ask)
    assert caught.value.faults[0].key == "follower"


def test_commands(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "free.toml"
    scene.write_text(FREE)
    assert main(["table", str(scene), "--step", "10"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 37
    assert main(["check", str(scene)]) == 0
    assert "largest-velocity" in capsys.readouterr().out
    assert main(["check", "--json", str(scene)]) == 0
    reported = json.loads(capsys.readouterr().out)
    assert reported["discs"] == {}
    assert {each["name"] for each in reported["findings"]} >= {"laws", "largest-velocity"}
    for what in ([], ["motion"]):
        words = ["plot", str(scene), *what, "-o", str(tmp_path / "free.svg"), "--force"]
        assert main(words) == 0
    assert "motion plan of the follower" in (tmp_path / "free.svg").read_text()
    capsys.readouterr()
    for words in (["build", "--only", "dxf", "-o", str(tmp_path / "out")], ["size"]):
        assert main([words[0], str(scene), *words[1:]]) == 2
        assert "follower: is missing: a disc needs it" in capsys.readouterr().err
    assert main(["plot", str(scene), "cam", "-o", str(tmp_path / "cam.svg")]) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["free.svg", "free.toml"]


def test_a_follower_can_be_added() -> None:
    scene = camgeo.loads(FREE).scene
    follower = {"kind": "translating-roller", "base_radius": 60, "roller_radius": 10}
    made = scene.with_values({"follower": follower})
    assert made.plan is scene.plan
    assert made == Scene({**scene.values, "follower": follower})
    assert camgeo.Design(made).findings
