"""`camgeo size`: what it prints, the scene it writes, what it refuses."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import camgeo
from camgeo.app.cli.main import main
from camgeo.check.disc import transmission_angle_limit
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.scene.toml import template
from camgeo.units import MM_PER

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"
SETZHUB = str(SCENES / "setzhub.toml")

Capture = pytest.CaptureFixture[str]


def sizes(base_radius: float) -> dict[str, float]:
    return {"follower.base_radius": base_radius, "follower.offset": 0.0}


def test_flocke_is_optimistic_about_the_curvature(capsys: Capture) -> None:
    assert main(["size", str(SCENES / "schnitt.toml")]) == 0
    out = capsys.readouterr().out
    assert "decided by r_R/r_K of 0.87 at cam angle" in out
    assert "Flocke's proposal is optimistic" in out


def test_json(capsys: Capture) -> None:
    assert main(["size", SETZHUB, "--transmission-angle", "45", "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    assert reported["required"]["transmission_angle_deg"] == pytest.approx(45.0)
    smallest = reported["smallest"]
    assert smallest["transmission_angle"]["smallest_deg"] == pytest.approx(45.0, abs=1e-9)
    assert math.hypot(*smallest["pivot_mm"]) == pytest.approx(smallest["pivot_distance_mm"])
    x, y = smallest["pivot_mm"]
    assert y / x == pytest.approx(62.0 / 40.46)  # the pivot stays in its direction
    assert reported["flocke"]["base_radius_mm"] > smallest["base_radius_mm"]
    assert len(reported["active"]) == 2
    assert reported["infeasible"] is None


def test_an_arm_is_found_and_written(tmp_path: Path, capsys: Capture) -> None:
    target = tmp_path / "sized.toml"
    call = ["size", SETZHUB, "--arm", "40", "40", "--scene", str(target)]
    assert main(call) == 0
    assert "all but the present design have an arm of 40.0000 mm" in capsys.readouterr().out
    after = camgeo.load(target)
    assert isinstance(after.cam.follower, OscillatingRoller)
    assert after.cam.follower.arm == 40.0
    assert main(["size", str(target), "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    assert reported["written"]["arm_mm"] == 40.0
    assert reported["written"]["base_radius_mm"] == after.cam.follower.base_radius


def test_an_arm_is_refused_where_there_is_none(capsys: Capture) -> None:
    scene = str(SCENES / "plate_translating.toml")
    assert main(["size", scene, "--arm", "40", "60"]) == 2
    assert "follower.kind = translating-roller" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["translating-flat", "oscillating-flat"])
def test_flat_faces_are_sized(kind: str, tmp_path: Path, capsys: Capture) -> None:
    scene, target = tmp_path / "scene.toml", tmp_path / "sized.toml"
    scene.write_text(template(kind))
    call = ["size", str(scene), "--radius-of-curvature", "4", "--scene", str(target)]
    assert main([*call, "-o", str(tmp_path / "size.svg")]) == 0
    out = capsys.readouterr().out
    assert "a convex cam with radii of curvature of at least 4 mm" in out
    assert "decided by the radius of curvature at cam angle" in out
    found = {each.name: each for each in camgeo.load(target).findings}
    assert found["convexity"].severity == "ok"
    assert found["convexity"].value == pytest.approx(4.0, abs=1e-3)
    assert {each.severity for each in found.values()} <= {"ok", "warning"}
    assert main(["size", str(scene), "--arm", "40", "60"]) == 2
    assert "only an oscillating roller follower has an arm" in capsys.readouterr().err
    assert main(["size", str(scene), "--radius-of-curvature", "-1"]) == 2
    assert "radius_of_curvature = -1: must be a length" in capsys.readouterr().err


def test_infeasible_is_1_and_writes_no_scene(tmp_path: Path, capsys: Capture) -> None:
    target = tmp_path / "sized.toml"
    scene = str(SCENES / "flat_rocker.toml")
    call = ["size", scene, "--transmission-angle", "88", "--scene", str(target)]
    assert main(call) == 1
    captured = capsys.readouterr()
    assert "infeasible: with its pivot there, no base radius gives a convex cam" in captured.out
    assert "not written" in captured.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "scene",
    ["plate_translating", "setzhub", "schnitt", "groove", "ring", "inch", "vorschub"],
)
def test_the_scene_written_keeps_its_limits(scene: str, tmp_path: Path, capsys: Capture) -> None:
    source, target = SCENES / f"{scene}.toml", tmp_path / "sized.toml"
    assert main(["size", str(source), "--json", "--scene", str(target)]) == 0
    reported = json.loads(capsys.readouterr().out)
    before, after = camgeo.load(source), camgeo.load(target)
    assert after.cam.follower.base_radius == reported["written"]["base_radius_mm"]
    assert not [each for each in after.findings if each.severity not in ("ok", "warning")]
    inside = MM_PER[before.scene.unit]
    limit = reported["smallest"]["base_radius_mm"]
    last = 1e-4 if before.scene.unit == "mm" else 1e-5 * inside
    assert limit <= after.cam.follower.base_radius < limit + last
    line = next(line for line in target.read_text().splitlines() if "base_radius" in line)
    assert len(line.partition("=")[2].partition("#")[0].strip()) <= 8
    limit = math.degrees(transmission_angle_limit(before.cam, before.scene.limits))
    for finding in after.findings:
        if finding.name == "transmission-angle":
            assert finding.severity == "ok"
            assert finding.value is not None
            assert limit <= finding.value
        if finding.name.startswith("radius-ratio"):
            assert finding.severity == "ok"
    # Nothing but the sizes is another one.
    changed = ("base_radius", "offset", "pivot", "arm_side", "direction")
    old, new = (
        [line for line in text.splitlines() if not line.startswith(changed)]
        for text in (source.read_text(), target.read_text())
    )
    assert old == new
    assert after.cam.drive.motion.jet(before.drive.smooth_angles).tolist() == (
        before.cam.drive.motion.jet(before.drive.smooth_angles).tolist()
    )


def test_comments_stay_and_a_missing_offset_is_added(tmp_path: Path) -> None:
    source = tmp_path / "mine.toml"
    for kind in ("translating-roller", "oscillating-roller"):
        text = template(kind)
        source.write_text(text)
        scene = camgeo.load(source).scene
        written = scene.with_values({"follower.base_radius": 51.0}).to_toml()
        assert "\nbase_radius = 51.0 " in written
        assert [line.partition("#")[2] for line in written.splitlines()] == [
            line.partition("#")[2] for line in text.splitlines()
        ]
    text = (SCENES / "ring.toml").read_text()
    assert "\noffset" not in text
    scene = camgeo.load(SCENES / "ring.toml").scene
    written = scene.with_values(sizes(61.0)).to_toml()
    assert "\nbase_radius = 61.0\noffset = 0.0\n" in written


def test_a_follower_in_one_line_is_written_back_in_one_line() -> None:
    text = """camgeo = 1
name = "short"
cam = { rotation = "ccw" }
follower = { kind = "translating-roller", base_radius = 40, roller_radius = 8 }  # one line
motion = [{ dwell = 360 }]
"""
    scene = camgeo.loads(text).scene
    written = scene.with_values(sizes(41.5)).to_toml()
    assert 'follower = { kind = "translating-roller", base_radius = 41.5, ' in written
    assert "offset = 0.0" in written
    assert "# one line" in written


def test_nothing_is_written_over(tmp_path: Path, capsys: Capture) -> None:
    target = tmp_path / "mine.toml"
    target.write_text("mine")
    scene = str(SCENES / "plate_translating.toml")
    call = ["size", scene, "--scene", str(target), "-o", str(tmp_path / "size.svg")]
    assert main(call) == 2
    assert target.read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]
    assert main([*call, "--force"]) == 0
    assert b"<svg" in (tmp_path / "size.svg").read_bytes()
