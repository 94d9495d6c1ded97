"""What is told of a scene: the findings of a check, and where they are on the disc."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.check import check
from camgeo.app.designing.children import Job
from camgeo.app.designing.work import Recent, run
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.scene.toml import template
from tests.answers.documents import FIXTURES, SCENES
from tests.designing.scenes import SETZHUB, job
from tests.long_form import LONG

REFUSED = FIXTURES / "refused"
KINDS = ("setzhub", "conjugate_lever", "inch", "global_undercut", "d_shaft")
JUDGED = [path for path in SCENES if LONG or path.stem in KINDS]
"""Scenes with all kinds of findings; all of them in the long form."""


@pytest.mark.parametrize("path", JUDGED, ids=lambda path: path.stem)
def test_findings_are_those_of_a_check(path: Path) -> None:
    recent, asked = Recent(), job("findings", path, machining=False)
    found = run(asked, recent)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    checked = check(recent.design(asked), machining=False)
    assert found["faults"] == []
    assert [each["sentence"] for each in found["findings"]] == [
        each.sentence for each in checked.everything
    ]
    assert [each["verdict"] for each in found["findings"]] == [
        each.verdict for each in checked.everything
    ]
    assert [each["sentence"] for each in found["cures"]] == [
        f"{each.fault}: {each.sentence}" for each in checked.cures
    ]
    assert [each["works"] for each in found["cures"]] == [each.works for each in checked.cures]
    bad = [each for each in found["findings"] if each["severity"] != "ok"]
    assert all(each["step"] for each in bad)


def test_effects_have_diagrams_once_they_are_on() -> None:
    text = template("milled")
    assert run(Job("findings", text, arguments={"machining": False}))["charts"] == []
    on = run(Job("change", text, arguments={"effect": {"name": "kinematics", "on": True}}))
    assert on["effects"] == ["kinematics"]
    found = run(Job("findings", on["text"], arguments={"machining": False}))
    assert [each["name"] for each in found["charts"]] == ["effects-1"]
    assert found["charts"][0]["readings"]


def test_programs_are_judged_unless_they_are_left_out() -> None:
    about = [each["about"] for each in run(job("findings", SETZHUB))["findings"]]
    less = run(job("findings", SETZHUB, machining=False))["findings"]
    assert any(each.startswith("program") for each in about)
    assert [each["about"] for each in less] == [
        each for each in about if not each.startswith("program")
    ]


@pytest.mark.parametrize("name", ["global_undercut", "return_undercut", "undercut_tappet"])
def test_undercut_is_shown_where_it_is(name: str) -> None:
    path = REFUSED / f"{name}.toml"
    places = run(job("findings", path, machining=False))["places"]
    undercut = [each for each in places if each["kind"] == "undercut"]
    assert undercut
    design = Design(load_scene(path))
    disc = design.cams[-1 if "return" in undercut[0]["label"] else 0].disc
    phi = np.linspace(0.0, math.tau, 20001)
    curve = disc.inner_curve.point(phi)
    for each in undercut:
        assert np.min(np.abs(curve - complex(each["x"], each["y"]))) < 0.05
        angle = math.radians(float(each["label"].split()[-1].removesuffix("°")))
        there = disc.inner_curve.point(np.array([angle]))[0]
        step = np.max(np.abs(np.diff(curve))) * 0.05 / math.degrees(phi[1])
        assert abs(there - complex(each["x"], each["y"])) <= step + 1e-3


def test_a_scene_with_faults_has_no_findings() -> None:
    found = run(Job("findings", "camgeo = 1"))
    assert found["faults"]
    assert "findings" not in found
