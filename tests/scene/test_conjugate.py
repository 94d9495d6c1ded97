"""Scenes with [follower.return] or [follower.yoke]: what is read, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import camgeo
from camgeo.check.disc import disc_findings
from camgeo.design.design import Design
from camgeo.dynamics.effects.registry import ONE_DISC
from camgeo.errors import SceneError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.scene.scene import parse_scene
from tests.effects.scenes import only_for
from tests.findings import known
from tests.scene.scenes import FIXTURES, refusal_of, spoilt

LEVER = (FIXTURES / "conjugate_lever.toml").read_text()
CARRIAGE = (FIXTURES / "conjugate_carriage.toml").read_text()
SETZHUB = (FIXTURES / "setzhub.toml").read_text()

FAULTS: list[tuple[str, list[tuple[str, str]], str]] = [
    (LEVER, [("arm_angle = 84", "arm_angle = 0")], "above -360 and below 360 .*, and not 0"),
    (LEVER, [("arm_angle = 84", "arm_angle = 360")], "above -360 and below 360"),
    (LEVER, [("arm_angle = 84\n", "")], "follower.return.arm_angle: is missing: Angle from"),
    (LEVER, [("arm_angle = 84", "spacing = 84")], "return.spacing = 84: belongs to the return"),
    (LEVER, [("arm = 70", "arm = -70")], "follower.return.arm = -70: must be a positive"),
    (LEVER, [("arm_angle", "arm_angel")], r"did you mean arm_angle\?"),
    (LEVER, [("[follower.return]", "[follower.returns]")], r"did you mean return\?"),
    (CARRIAGE, [("spacing = 135", "spacing = 57")], "return.spacing = 57: the return roller must"),
    (CARRIAGE, [("spacing = 135\n", "")], "follower.return.spacing: is missing: Distance"),
    (
        LEVER,
        [('contact = "inner"', 'contact = "groove"'), ("bore = 24", "bore = 24\nrim = 200")],
        'follower.return: belongs to contact "inner"',
    ),
    (
        CARRIAGE,
        [("tolerance = 0.001", "tolerance = 1e-7"), ("spacing = 135", "spacing = 13500")],
        "output.tolerance = 1e-7: must be at least 1e-10 of the largest length, 13500 mm",
    ),
    (
        LEVER,
        [("bore = 24", "bore = 24\npair = { gap = 5, spacer = 24 }")],
        r"part.pair.spacer = 24: must be more than the bore, 24",
    ),
    (LEVER, [("thickness = 12", "pair = { gap = 5, spacer = 40 }")], r"pair: needs \[part\] thick"),
    (LEVER, [("bore = 24", "pair = { gap = 5 }\nbore = 24")], "part.pair.spacer: is missing"),
    (
        SETZHUB,
        [("[part]", "[part]\npair = { gap = 5, spacer = 40 }")],
        r"part.pair.*: belongs to a conjugate pair: it needs \[follower.return\]",
    ),
    (
        SETZHUB,
        [("[limits]", "[limits]\nclosing_error = 0.1")],
        r"limits.closing_error = 0.1: belongs to a pair or a yoke",
    ),
]


def faults_of(text: str) -> str:
    return str(refusal_of(text))


@pytest.mark.parametrize(("text", "changes", "expected"), FAULTS, ids=range(len(FAULTS)))
def test_faults(text: str, changes: list[tuple[str, str]], expected: str) -> None:
    if "limits" in changes[0][0] and "[limits]" not in text:
        text += "\n[limits]\n"
    with pytest.raises(SceneError, match=expected):
        parse_scene(spoilt(text, *changes))


def test_a_return_arm_on_the_line_of_centres_is_reported_with_its_key() -> None:
    follower = parse_scene(LEVER).follower
    assert isinstance(follower, OscillatingRoller)
    angle = math.degrees(follower.start_angle)
    reported = faults_of(LEVER.replace("arm_angle = 84", f"arm_angle = {angle!r}"))
    assert f"follower.return.arm_angle = {angle!r}: the return arm lies on the line" in reported


def test_all_faults_are_reported_at_once() -> None:
    text = LEVER.replace("arm_angle = 84", "arm_angle = 400").replace("dwell = 40", "dwell = 41")
    text += "\n[effects.balance]\n[effects.friction]\nguide_length = 90\n"
    reported = faults_of(text)
    keys = (
        "follower.return.arm_angle",
        "motion",
        "effects.balance",
        "effects.friction.guide_length",
    )
    for key in keys:
        assert f"{key}" in reported


@pytest.mark.parametrize("name", [name for name, key in only_for(ONE_DISC) if not key])
def test_effects_of_one_disc_are_refused(name: str) -> None:
    assert f"effects.{name}: supports a single disc," in faults_of(f"{LEVER}\n[effects.{name}]\n")


def test_lengths_are_in_the_unit_of_the_scene() -> None:
    scene = parse_scene(
        spoilt(
            CARRIAGE, ("[cam]", '[units]\nlength = "inch"\n[limits]\nclosing_error = 1\n[cam]'),
            ("base_radius = 58", "base_radius = 2"), ("\noffset = 6", "\noffset = 0.5"),
            ("spacing = 135", "spacing = 5"), ("offset = -5", "offset = -0.25"),
            ("roller_radius = 12", "roller_radius = 0.5"),
            ("roller_radius = 10", "roller_radius = 0.25"), ("to = 18", "to = 0.5"),
            ("bore = 25", "bore = 1"), ("diameter = 12", "diameter = 0.5"),
        )
    )  # fmt: skip
    returning = scene.returning
    assert isinstance(returning, TranslatingRoller)
    assert returning.roller_radius == pytest.approx(6.35, rel=1e-15)
    assert returning.offset == pytest.approx(6.35, rel=1e-15)
    assert returning.start_height == pytest.approx(25.4 * (5.0 - math.sqrt(4.0 - 0.25)), rel=1e-14)
    assert scene.limits.closing_error == pytest.approx(25.4)


def test_the_return_disc_is_a_design_of_its_own() -> None:
    effects = "\n[effects.inertia]\nmoment_of_inertia = 0.05\n"
    design = Design(parse_scene(LEVER + effects))
    main, other = design.discs
    assert main.discs == design.discs
    assert other.name == "conjugate_lever-return"
    assert other.columns() == ()
    assert other.discs == (other,)
    assert other.cam.drive.motion == design.cam.drive.motion
    assert (other.scene_hash, other.cam.rotation) == (design.disc.scene_hash, design.cam.rotation)
    reported = {each.name for each in design.findings}
    own = {each.name for each in disc_findings(other.cam, design.scene.limits)}
    assert {f"return: {name}" for name in own} <= reported
    told_of = [each for each in design.findings if each.name.startswith("return: ")]
    assert all(each.sentence.startswith("return disc: ") for each in told_of)


def test_a_return_disc_that_undercuts_leaves_no_outline() -> None:
    text = LEVER.replace("roller_radius = 12", "roller_radius = 46")
    design = Design(parse_scene(text))
    bad = {each.name for each in design.findings if each.severity == "no-disc"}
    assert bad
    assert all(name.startswith("return: ") for name in bad)
    assert not design.judgement.has_outline
    assert not design.discs[1].judgement.has_outline


SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

TEXT = (SCENES / "constant_breadth.toml").read_text(encoding="utf-8")

PLATE = (SCENES / "plate_translating.toml").read_text(encoding="utf-8")

SHUTTLE = (SCENES / "shuttle.toml").read_text(encoding="utf-8")

YOKE = "[follower.yoke]\nbreadth = 66\n"

EVEN = "[[motion]]\ndwell = 20\n[[motion]]\nlaw = 'modified-sine'\nspan = 160\nto = 20\n"
EVEN += "[[motion]]\ndwell = 20\n[[motion]]\nlaw = 'modified-sine'\nspan = 160\nto = 0\n"


def closing(text: str) -> camgeo.Finding:
    """The finding of the yoke."""
    return ({each.name: each for each in Design(parse_scene(text)).findings})["closing-error"]


def on_rollers(yoke: str = "[follower.yoke]\n", offset: str = "") -> str:
    """The plate cam of the fixtures with an even motion and a yoke on rollers."""
    head, _, rest = PLATE.partition("[[motion]]")
    tail = rest[rest.index("[part]") :]
    return head.replace("offset = 12\n", offset) + yoke + EVEN + tail


def test_a_wrong_breadth_is_reported_with_its_error() -> None:
    finding = closing(TEXT.replace("breadth = 66", "breadth = 66.05"))
    assert finding.severity == "broken"
    assert finding.value == pytest.approx(0.05)
    limited = TEXT.replace("breadth = 66", "breadth = 66.05").replace(
        "[part]", "[limits]\nclosing_error = 0.06\n[part]"
    )
    assert closing(limited).severity == "ok"


def test_a_motion_that_does_not_undo_itself_is_reported() -> None:
    text = TEXT.replace("dwell = 50", "dwell = 40", 1).replace("span = 130", "span = 140", 1)
    finding = closing(text)
    assert finding.severity == "broken"
    assert known(finding.value) > 0.1


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        (on_rollers(offset="offset = 12\n"), "follower.offset = 12: must be 0 for a yoke"),
        (
            on_rollers("[follower.yoke]\n[follower.return]\nspacing = 150\n"),
            "contradicts [follower.return]",
        ),
        (
            on_rollers().replace('contact = "inner"', 'contact = "outer"'),
            'belongs to contact "inner": a yoke encloses',
        ),
        (TEXT.replace("breadth = 66", "breadth = -1"), "follower.yoke.breadth = -1"),
        (TEXT.replace(YOKE, "yoke = 3\n"), "must be a table, headed [follower.yoke]"),
        (
            on_rollers() + "[effects.lift-off]\nbacklash = 0.1\n[effects.inertia]\nmass = 1\n",
            "effects.lift-off.backlash = 0.1: is not for a yoke, [follower.yoke], whose play",
        ),
        (
            PLATE + "[limits]\nclosing_error = 0.01\n",
            "it needs [follower.return] or [follower.yoke]",
        ),
        (SHUTTLE.replace("roller_radius = 10", "roller_radius = 10\nyoke = {}"), "yoke"),
    ],
)
def test_what_does_not_go_with_a_yoke_is_refused(text: str, reported: str) -> None:
    assert reported in str(refusal_of(text))


def test_for_a_refused_effect_nothing_missing_is_reported() -> None:
    table = "[effects.roller-spin]\nmoment_of_inertia = 1e-5\ntraction = 0.1\n"
    (fault,) = refusal_of(TEXT + table).faults
    assert fault.key == "effects.roller-spin"
    assert fault.message.startswith("is for roller followers")
