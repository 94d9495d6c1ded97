"""Scenes with a four-bar, and with a slider-crank whose slider carries the roller."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.scene.formats.format import find_format
from camgeo.scene.scene import parse_scene
from tests.findings import effect_findings
from tests.scene.scenes import LINKED

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
    assert made.drive.demanded_of == "lever"
    at = np.radians([200.0])
    assert made.drive.plan.jet(at)[0] == pytest.approx(math.radians(22.0), rel=1e-14)
    assert made.drive.motion.jet(at)[0] == pytest.approx(
        made.cam.drive.linkage.transform(made.drive.plan.jet(at))[0]
    )


def test_the_follower_decides_which_member_of_a_slider_crank_moves_as_demanded() -> None:
    made = loaded(SLIDER_DRIVEN)
    assert isinstance(made.cam.drive.linkage, SliderDrivenCrank)
    assert (made.drive.unit, made.drive.demanded_of, made.cam.lift_unit) == (
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
    with pytest.raises(SceneError) as caught:
        loaded(text, *changes)
    assert words in str(caught.value)


def test_no_range_of_no_width_is_proposed() -> None:
    with pytest.raises(SceneError) as caught:
        loaded(SLIDER_DRIVEN, ("coupler = 110", "coupler = 1e-9"))
    (fault,) = caught.value.faults
    assert "does not close" in fault.message
    assert "kept between" not in fault.message


def test_a_direction_that_contradicts_the_four_bar_is_reported() -> None:
    stated = "inward" if _moves_outward(loaded(FOUR_BAR)) else "outward"
    with pytest.raises(SceneError, match="contradicts the linkage"):
        loaded(FOUR_BAR, ("roller_radius = 8", f'roller_radius = 8\ndirection = "{stated}"'))


def _moves_outward(design: Design) -> bool:
    at = design.disc.pictured.curve("pitch", np.radians([0.0, 200.0]))
    return bool(np.linalg.norm(at[1]) > np.linalg.norm(at[0]))


@pytest.mark.parametrize(("text", "angle"), [(FOUR_BAR, "chi"), (SLIDER_DRIVEN, "theta")])
def test_the_table_has_both_motions(text: str, angle: str) -> None:
    made = loaded(text)
    table = made.tabulated.table()
    columns = dict(zip(table.names, table.values.T, strict=True))
    assert len(columns) == len(table.names)
    phi = np.radians(columns["phi [deg]"])
    assert columns[f"{angle} [deg]"] == pytest.approx(np.degrees(made.drive.plan.jet(phi)[0]))
    own = "psi' [1]" if made.cam.lift_unit == "rad" else "s' [mm/rad]"
    assert columns[own] == pytest.approx(made.drive.motion.jet(phi)[1])
    speed = made.scene.speed
    assert speed is not None
    assert columns[f"omega_{angle} [deg/s]"] == pytest.approx(
        np.degrees(made.drive.plan.jet(phi)[1]) * speed
    )


AT_ROCKER = """
[effects.kinematics]
[effects.inertia]
moment_of_inertia = 0.01
roller_mass = 0.1
[effects.spring]
kind = "torsion"
torsional_stiffness = 20
preload_torque = 20
[effects.contact-force]
[effects.drive-torque]
[effects.vibration]
natural_frequency = 90
damping = 0.05
"""

AT_SLIDER = """
[effects.kinematics]
[effects.inertia]
mass = 1
roller_mass = 0.1
[effects.spring]
stiffness = 5
preload = 300
[effects.friction]
guide = 0.1
[effects.contact-force]
[effects.drive-torque]
[effects.vibration]
natural_frequency = 90
damping = 0.05
"""


@pytest.mark.parametrize(
    ("text", "tables", "prefix"),
    [(FOUR_BAR, AT_ROCKER, "rocker"), (SLIDER_DRIVEN, AT_SLIDER, "follower")],
)
def test_effects_at_the_follower_itself_work(text: str, tables: str, prefix: str) -> None:
    made = loaded(text, ("[part]", f"{tables}[part]"))
    assert {each.severity for each in effect_findings(made)} <= {"ok", "warning"}
    names = {column.name: column for column in made.disc.columns()}
    phi = np.radians(np.arange(0.5, 360.0, 7.0))
    own = names[f"{prefix} velocity"].values(phi, "right")
    speed = made.scene.speed
    assert speed is not None
    scale = math.degrees(1.0) if made.cam.lift_unit == "rad" else 1.0
    assert own == pytest.approx(scale * speed * made.drive.motion.jet(phi)[1], abs=1e-9)
    # Kinetic energy of what moves with the follower: its own, whatever the linkage.
    inertia = made.effect("inertia")
    mass = 1e3 * 0.01 + 1e-4 * 80.0**2 if made.cam.lift_unit == "rad" else 1.1e-3
    assert inertia.to_follower(phi, "right") == pytest.approx(np.full(len(phi), mass))


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
