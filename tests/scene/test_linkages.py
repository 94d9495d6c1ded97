"""Scenes with linkages and with flat faces: their keys, their motions, and what is refused."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.cli.main import main
from camgeo.check.disc import TRIM
from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.linkages import FourBar, SliderDrivenCrank
from camgeo.scene.formats.format import find_format
from camgeo.scene.scene import parse_scene
from camgeo.scene.toml import template
from tests.findings import effect_findings
from tests.scene.scenes import LINKED, refusal_by, refusal_of, spoilt

FIXTURES = Path(__file__).parents[2] / "fixtures" / "scenes"
FOUR_BAR = (FIXTURES / "four_bar.toml").read_text(encoding="utf-8")
SLIDER_DRIVEN = (FIXTURES / "crank_slider.toml").read_text(encoding="utf-8")

INERTIA = "[effects.inertia]\n"


def loaded(text: str, *changes: tuple[str, str]) -> Design:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return Design(parse_scene(text))


def test_the_keys_of_a_four_bar() -> None:
    inch = loaded(FOUR_BAR, ('name = "four_bar"', 'name = "four_bar"\n[units]\nlength = "inch"'))
    assert inch.cam.drive.linkage == FourBar(
        70 * 25.4, 120 * 25.4, 85 * 25.4, 25.4 * (-110 + 29j), math.radians(270.0), -1, -1
    )
    made = loaded(FOUR_BAR, ('lever_sense = "cw"\n', ""))
    assert isinstance(made.cam.drive.linkage, FourBar)
    assert made.cam.drive.linkage.lever_sense == 1
    # Positions are degrees of the lever; the rocker's own angle is another one.
    assert made.drive.unit == "rad"
    assert made.drive.demanded_member == "lever"
    at = np.radians([200.0])
    assert made.drive.plan.jet(at)[0] == pytest.approx(math.radians(22.0), rel=1e-14)
    assert made.drive.motion.jet(at)[0] == pytest.approx(
        made.cam.drive.linkage.transform(made.drive.plan.jet(at))[0]
    )


def test_the_follower_decides_which_member_of_a_slider_crank_moves_as_demanded() -> None:
    made = loaded(SLIDER_DRIVEN)
    assert isinstance(made.cam.drive.linkage, SliderDrivenCrank)
    assert (made.drive.unit, made.drive.demanded_member, made.cam.lift_unit) == (
        "rad",
        "crank",
        "mm",
    )
    inward = loaded(SLIDER_DRIVEN, ('"outward"', '"inward"'))
    at = np.radians([180.0])
    # A positive stroke of the slider moves the roller the way `direction` says.
    assert made.drive.motion.jet(at)[0][0] == inward.drive.motion.jet(at)[0][0] > 0.0
    grown = [
        np.linalg.norm(each.disc.pictured.curve("pitch", at)) - each.cam.follower.base_radius
        for each in (made, inward)
    ]
    assert grown[0] > 0.0 > grown[1]
    # Without the linkage the same numbers are millimetres.
    head, _, rest = SLIDER_DRIVEN.partition("[linkage]")
    plain = Design(parse_scene(head + rest[rest.index("[[motion]]") :].replace("-40", "20")))
    assert plain.drive.unit == "mm"


@pytest.mark.parametrize("text", [FOUR_BAR, SLIDER_DRIVEN])
def test_points_of_opticurv_need_a_rocker_behind_a_slider(text: str) -> None:
    (fault,) = loaded(text, ('"csv", ', '"csv", "asc", ')).scene.lacking([find_format("asc")])
    assert fault.message == 'needs [linkage] kind = "slider-crank" and a rocker'


@pytest.mark.parametrize(
    ("text", "changes", "words"),
    [
        (
            SLIDER_DRIVEN,
            [('"slider-crank"', '"four-bar"')],
            'follower.kind = "translating-roller": a four-bar turns a rocker',
        ),
        (FOUR_BAR, [('branch = "ccw"\n', "")], "linkage.branch: is missing"),
        (FOUR_BAR, [("lever = 85", "levr = 85")], "did you mean lever"),
        (FOUR_BAR, [("to = 22", "to = 4000")], "must lie between -3600 and 3600"),
        (FOUR_BAR, [("coupler = 120", "coupler = 12")], "does not close at motion 0"),
        (FOUR_BAR, [("to = 22", "to = 150")], "does not close between cam angles"),
        (
            SLIDER_DRIVEN,
            [("coupler = 110", "coupler = 3")],
            "it closes with a coupler of at least",
        ),
        (
            "".join(FOUR_BAR.partition("[linkage]")[:1])
            + "[limits]\nlinkage_transmission_angle = 40\n"
            + FOUR_BAR[FOUR_BAR.index("[[motion]]") :].replace("to = 22", "to = 2"),
            [],
            "limits.linkage_transmission_angle = 40: belongs to a linkage",
        ),
        (
            FOUR_BAR,
            [("[part]", 'direction = "x"\n[part]')],
            "direction",
        ),
        *(
            (text, [("[part]", f"{table}\n[part]")], "is for a slider that drives a rocker")
            for text, table in (
                (FOUR_BAR, f"{INERTIA}mass = 1"),
                (FOUR_BAR, "[effects.friction]\nslider = 3"),
                (FOUR_BAR, "[effects.friction]\nguide_viscous = 3"),
                (SLIDER_DRIVEN, "[effects.friction]\nslider = 3"),
            )
        ),
    ],
)
def test_the_impossible_is_refused(text: str, changes: list[tuple[str, str]], words: str) -> None:
    with pytest.raises(SceneError, match=re.escape(words)):
        loaded(text, *changes)


def test_no_range_of_no_width_is_proposed() -> None:
    (fault,) = refusal_by(loaded, SLIDER_DRIVEN, ("coupler = 110", "coupler = 1e-9")).faults
    assert "does not close" in fault.message
    assert "kept between" not in fault.message


def test_a_direction_that_contradicts_the_four_bar_is_reported() -> None:
    stated = "inward" if _moves_outward(loaded(FOUR_BAR)) else "outward"
    with pytest.raises(SceneError, match="contradicts the linkage"):
        loaded(FOUR_BAR, ("roller_radius = 8", f'roller_radius = 8\ndirection = "{stated}"'))


def _moves_outward(design: Design) -> bool:
    at = design.disc.pictured.curve("pitch", np.radians([0.0, 200.0]))
    return bool(np.linalg.norm(at[1]) > np.linalg.norm(at[0]))


def test_data_of_another_linkage_are_refused_from_outside_too() -> None:
    for text, table in (
        (FOUR_BAR, "[effects.vibration]\ntorsional_stiffness = 30\n"),
        (FOUR_BAR, "[effects.spring]\nstiffness = 5\npreload = 30\n"),
    ):
        moment = f"{INERTIA}moment_of_inertia = 0.01\n"
        made = loaded(text, ("[part]", f"{moment}{table}[part]"))
        with pytest.raises(GeometryError) as caught:
            _ = effect_findings(made)
        assert caught.value.key.startswith("effects.")


@pytest.mark.parametrize("stated", ["outward", "inward"])
def test_where_nothing_moves_no_direction_contradicts_the_linkage(stated: str) -> None:
    head = LINKED.partition("[[motion]]")[0].replace('"outward"', f'"{stated}"')
    scene = parse_scene(f"{head}[[motion]]\ndwell = 360\n")
    assert len(scene.plan.segments) == 1


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
    said = {
        "follower.roller_radius": "belongs to a translating-roller follower",
        "follower.contact": "belongs to a translating-roller follower",
        "follower.offset": "belongs to a translating-roller follower",
        "follower.face": "must end beyond where it begins",
        "limits.radius_ratio": "is for roller followers",
        "effects.inertia.roller_mass": "is for roller followers",
        "effects.friction.rolling": "is for roller followers",
        "effects.friction.guide_length": "tilts",
    }
    faults = {fault.key: fault.message for fault in refusal_of(text).faults}
    assert faults.keys() == said.keys()
    for key, words in said.items():
        assert words in faults[key]


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
    inward, outward = (
        spoilt(linked, ("face_offset = 16", f'direction = "{word}"\nface_offset = 16'))
        for word in ("inward", "outward")
    )
    assert parse_scene(inward).follower == follower
    (fault,) = refusal_of(outward).faults
    assert fault.key == "follower.direction"
    assert "which moves the face inward" in fault.message


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
