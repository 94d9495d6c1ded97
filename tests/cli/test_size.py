"""`camgeo size`: what it prints, the scene it writes, what it refuses."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import camgeo
from camgeo.check.disc import transmission_angle_limit
from camgeo.scene.toml import template
from camgeo.units import MM_PER
from tests.cli.calling import SCENES, called


def test_flocke_is_optimistic_about_the_curvature() -> None:
    out = called("size", SCENES / "schnitt.toml").out
    assert "determined by r_R/r_K of 0.87 at cam angle" in out
    assert "Flocke's proposal is optimistic" in out


@pytest.mark.parametrize("kind", ["translating-flat", "oscillating-flat"])
def test_flat_faces_are_sized(kind: str, tmp_path: Path) -> None:
    scene, target = tmp_path / "scene.toml", tmp_path / "sized.toml"
    scene.write_text(template(kind))
    words = ("--radius-of-curvature", "4", "--scene", target, "-o", tmp_path / "size.svg")
    out = called("size", scene, *words).out
    assert "a convex cam with radii of curvature of at least 4 mm" in out
    assert "determined by the radius of curvature at cam angle" in out
    found = {each.name: each for each in camgeo.load(target).findings}
    assert found["convexity"].severity == "ok"
    assert found["convexity"].value == pytest.approx(4.0, abs=1e-3)
    assert {each.severity for each in found.values()} <= {"ok", "warning"}


def test_infeasible_is_1_and_writes_no_scene(tmp_path: Path) -> None:
    words = ("--transmission-angle", "88", "--scene", tmp_path / "sized.toml")
    found = called("size", SCENES / "flat_rocker.toml", *words)
    assert found.code == 1
    assert "infeasible: with its pivot there, no base radius gives a convex cam" in found.out
    assert "not written" in found.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "scene",
    ["plate_translating", "setzhub", "schnitt", "groove", "ring", "inch", "vorschub"],
)
def test_the_scene_written_keeps_its_limits(scene: str, tmp_path: Path) -> None:
    source, target = SCENES / f"{scene}.toml", tmp_path / "sized.toml"
    reported = called("size", source, "--json", "--scene", target).document
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
