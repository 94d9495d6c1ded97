"""Flat-faced followers in scenes: their own keys, those of rollers only, and linkages."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from camgeo.app.cli.main import main
from camgeo.check.judge import TRIM
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.scene.formats.format import find_format
from camgeo.scene.scene import parse_scene
from camgeo.scene.toml import template
from tests.scene.scenes import refusal_of, spoilt

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

TAPPET, ROCKER = template("translating-flat"), template("oscillating-flat")

LINKAGE = """
[linkage]
kind = "slider-crank"
crank = 160.5
coupler = 122.87
crank_deflection = 34.68
crank_leans = "away"
slider_side = "right"
stroke_direction = "right"
branch = "ccw"
"""


EFFECTS = """
[effects.kinematics]
[effects.inertia]
mass = 1
roller_mass = 1
[effects.friction]
guide = 0.1
rolling = 0.1
"""


def test_all_that_is_for_rollers_is_refused_at_once() -> None:
    text = spoilt(
        TAPPET,
        ("base_radius = 40", "base_radius = 40\nroller_radius = 5\ncontact = 'inner'\noffset = 2"),
        ("face = [-16, 16]", "face = [16, -16]"),
        ("\n[part]", "\n[limits]\nundercut = 'trim'\nradius_ratio = 0.6\n[part]"),
        ("\n[output]", f"{EFFECTS}\n[output]"),
    )
    faults = {fault.key: fault.message for fault in refusal_of(text).faults}
    for key in ("follower.roller_radius", "follower.contact", "follower.offset"):
        assert "belongs to a translating-roller follower" in faults.pop(key)
    assert "must end beyond where it begins" in faults.pop("follower.face")
    assert "limits.undercut" not in faults
    for key in (
        "limits.radius_ratio",
        "effects.inertia.roller_mass",
        "effects.friction.rolling",
    ):
        assert "is for roller followers" in faults.pop(key)
    assert "tilts" in faults.pop("effects.friction.guide_length")
    assert not faults


def test_points_of_opticurv_are_for_rollers() -> None:
    scene = parse_scene(spoilt(TAPPET, ('= ["dxf"', '= ["asc", "dxf"')))
    (linkage, roller) = scene.lacking([find_format("asc")])
    assert linkage.message == "needs [linkage]"
    assert str(roller).endswith('output.formats[1] = "asc": is for roller followers')


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (("[-96, 30]", "[0, 0]"), "follower.pivot", "lies on the cam axis"),
        (("face_offset = 6", "face_offset = -101"), "follower.face_offset", "be above -100.578 mm"),
        (("face_offset = 6", "face_offset = 146"), "follower.base_radius", "between 45.4"),
    ],
)
def test_a_face_that_fits_at_no_distance_is_refused_with_the_reason(
    change: tuple[str, str], key: str, words: str
) -> None:
    (fault,) = refusal_of(spoilt(ROCKER, change)).faults
    assert fault.key == key
    assert words in fault.message


def test_effects_that_are_no_table_are_one_fault() -> None:
    text = spoilt(TAPPET, ("camgeo = 1 ", "effects = 3\ncamgeo = 1 "))
    assert {fault.key for fault in refusal_of(text).faults} == {"effects"}


def test_lengths_and_angles_are_converted() -> None:
    inch = spoilt(
        TAPPET,
        ('= "mm" ', '= "inch" '), ("base_radius = 40", "base_radius = 1.5"), ("= 90 ", "= 60 "),
        ("to = 12", "to = 0.5"), ("[-16, 16]", "[-0.75, 1]"), ("bore = 20", "bore = 0.75"),
        ("{ width = 6, depth = 2.8 }", "{ width = 0.2, depth = 0.1 }"),
        ("tolerance = 0.001", "tolerance = 0.0001"), ("diameter = 10", "diameter = 0.5"),
        ("stepover = 2", "stepover = 0.1"),
    )  # fmt: skip
    follower = parse_scene(inch).follower
    assert follower == TranslatingFlat(1.5 * 25.4, math.radians(60.0), 1, (-0.75 * 25.4, 25.4))
    rocker = parse_scene(ROCKER).follower
    assert rocker == OscillatingFlat(-96.0 + 30.0j, 45.0, 6.0, 1, 1, (65.0, 125.0))
    assert Design(parse_scene(ROCKER)).cam.lift_unit == "rad"
    assert Design(parse_scene(TAPPET)).cam.lift_unit == "mm"


def test_a_linkage_drives_a_flat_rocker() -> None:
    linked = spoilt(
        ROCKER, ("[[motion]]\ndwell = 30 ", f"{LINKAGE}[[motion]]\ndwell = 30 "),
        ('direction = "outward"', "#"),
        ("to = 12", "to = 4"), ("base_radius = 45", "base_radius = 55"),
        ("face_offset = 6", "face_offset = 16"),
    )  # fmt: skip
    design = Design(parse_scene(linked))
    follower = design.cam.follower
    assert isinstance(follower, OscillatingFlat)
    assert follower.direction is None
    assert design.judgement.has_outline
    for word in ("outward", "inward"):
        stated = spoilt(linked, ("face_offset = 16", f'direction = "{word}"\nface_offset = 16'))
        try:
            parse_scene(stated)
        except SceneError as error:
            (fault,) = error.faults
            assert fault.key == "follower.direction"
            assert "which moves the face" in fault.message
            break
    else:
        pytest.fail("one of both directions contradicts the linkage")


@pytest.mark.parametrize("command", ["replay", "size"])
def test_commands_take_flat_faces(command: str) -> None:
    assert main([command, str(SCENES / "tappet.toml")]) == 0


def test_a_cam_that_is_not_convex_is_not_made(tmp_path: Path) -> None:
    scene = tmp_path / "small.toml"
    scene.write_text(spoilt(TAPPET, ("base_radius = 40", "base_radius = 5")))
    assert main(["build", str(scene), "-o", str(tmp_path / "out")]) == 1
    assert not (tmp_path / "out").exists()
    assert main(["plot", str(scene), "-o", str(tmp_path / "small.png")]) == 0


def test_a_cam_that_is_not_convex_is_trimmed_if_told_to(tmp_path: Path) -> None:
    small = (SCENES.parent / "refused" / "undercut_tappet.toml").read_text(encoding="utf-8")
    refused = Design(parse_scene(small))
    found = {finding.name: finding for finding in refused.findings}
    assert (found["convexity"].severity, found["lost-stroke-inner"].severity) == ("no-disc",) * 2
    assert TRIM in found["lost-stroke-inner"].sentence
    trimmed = spoilt(small, ('undercut = "refuse"', 'undercut = "trim"'))
    found = {finding.name: finding for finding in Design(parse_scene(trimmed)).findings}
    assert (found["convexity"].severity, found["lost-stroke-inner"].severity) == ("broken",) * 2
    assert found["face-length"].severity == "ok"
    scene = tmp_path / "trimmed.toml"
    scene.write_text(trimmed)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", "dxf,gcode"]) == 1
    drawing = tmp_path / "out" / f"{refused.name}.dxf"
    assert drawing.exists()
    assert main(["replay", str(scene), str(drawing)]) == 0


@pytest.mark.parametrize("text", [TAPPET, ROCKER])
def test_a_follower_that_rests_all_the_turn_is_drawn(text: str, tmp_path: Path) -> None:
    head, _, tail = text.partition("[[motion]]")
    end = tail[tail.index("\n[part]") :]
    resting = spoilt(f"{head}[[motion]]\ndwell = 360\n{end}", ("\nface =", "\n# face ="))
    scene = tmp_path / "resting.toml"
    scene.write_text(resting)
    assert main(["plot", str(scene), "cam", "-o", str(tmp_path / "resting.svg")]) == 0
