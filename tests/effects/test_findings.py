"""What findings of effects say: what their figures rely on (contact, the demanded motion, no better
model in the scene), that what nothing limits is a figure and rounding is 0, and that a result says
in Python what the command says.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache
from random import Random
from typing import Final

import numpy as np
import pytest

from camgeo.check.finding import MOST_ALIKE, Finding, folded
from camgeo.design.design import Design
from camgeo.dynamics.effects.contact_pressure import Life, life_findings
from camgeo.dynamics.effects.lift_off.flight import UNSETTLED, Flight, Flights, refined
from camgeo.dynamics.effects.lift_off.landing import with_bounces
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.results import CONTACT_FORCE, FINDERS
from camgeo.dynamics.effects.tables import PressureRequirements
from camgeo.dynamics.effects.wording import remaining_share
from camgeo.errors import EffectError
from camgeo.part.materials import find_material
from camgeo.scene.scene import load_scene
from tests.draws.doors import FIXTURES, contradictions, random_scene
from tests.effects.scenes import SCENES, design
from tests.effects.test_laziness import TABLES, TOGETHER
from tests.findings import finding, finding_of, names_of
from tests.long_form import LONG

LOST: Final = ((50.3518, 86.4716), (93.5284, 129.6482))
"""Where the rigid follower of both scenes leaves the cam [degrees]."""

REFUSED: Final = ('undercut = "trim"', 'undercut = "refuse"')
"""The scene is judged, and no disc is made of it."""

NEEDS_CONTACT: Final = tuple(name for name in TOGETHER if find_effect(name).premise == "contact")


@cache
def loaded(name: str) -> Design:
    return Design(load_scene(str(SCENES.parent / "effects" / f"{name}.toml")))


@cache
def rigidly(name: str) -> Design:
    path = SCENES.parent / "effects" / f"{name}.toml"
    return Design(load_scene(str(path)).with_values({"state.output": "rigid"}))


# Contact ------------------------------------------------------------------------------------------


def test_pressure_and_life_are_not_ok_while_the_roller_is_off_the_cam() -> None:
    weak = loaded("pressure_off_the_cam")
    lost = finding_of(weak, "contact-pressure", "contact-lost")
    assert lost.severity == "broken"
    assert lost.value == pytest.approx(-183.027, abs=1e-3)
    assert lost.limit == 0.0
    stated = re.findall(r"(\d+\.\d{4}) to (\d+\.\d{4})", lost.sentence)
    assert [(float(start), float(end)) for start, end in stated] == list(LOST)
    figures = [each for each in weak.effects.findings("contact-pressure") if each.value is not None]
    assert {"largest-contact-pressure", "roller-life"} <= {each.name for each in figures}
    assert not [each for each in figures if each.severity == "ok"]


@cache
def off_the_cam() -> Design:
    """A scene with every effect, whose spring is too weak."""
    wire = "wire = { diameter = 1, coil_diameter = 25, active_coils = 6, free_length = 90 }"
    return with_all(spring=f"preload = 1\n{wire}", load="constant = -500")


@cache
def with_all(speed: str = "found", **changed: str) -> Design:
    """A scene with every effect that one can have, some of whose tables are `changed`."""
    tables = {name: TABLES[name] for name in TOGETHER} | changed
    text = "\n".join(f"[effects.{name}]\n{table}" for name, table in tables.items())
    return design("plate_translating", f'{text}\n[state]\nspeed = "{speed}"\n')


def test_each_effect_that_takes_contact_for_granted_says_where_it_is_lost() -> None:
    weak = off_the_cam()
    assert {"contact-pressure", "drive-torque", "speed-fluctuation", "friction"} < {*NEEDS_CONTACT}
    for name in TOGETHER:
        stated = "contact-lost" in names_of(weak, name)
        assert stated == (name in NEEDS_CONTACT), name
        for each in weak.effects.findings(name) if stated else ():
            free = each.name in find_effect(name).regardless or each.value is None
            assert free or each.severity != "ok", each


def test_lift_off_and_contact_force_define_it_alike() -> None:
    for of in (loaded("lift_off_elastic"), rigidly("lift_off_elastic")):
        lost = of.effect(CONTACT_FORCE).lost_contact
        told = [each for each in of.effects.findings("lift-off") if each.name == "lift-off"]
        stated = [each.cam_range for each in told if each.cam_range]
        assert stated == [(each.start, each.end) for each in lost.ranges]
    assert np.degrees(stated) == pytest.approx(np.array(LOST), abs=1e-4)


def test_each_effect_says_where_the_follower_flies() -> None:
    """From the first place to the landing, which is beyond the second one."""
    rigid = rigidly("lift_off_elastic")
    ((start, end),) = rigid.effect("lift-off").flight_ranges
    flown = f"and flies from cam angle {math.degrees(start):.4f} to {math.degrees(end):.4f} deg;"
    for effect in ("contact-force", "drive-torque", "contact-pressure", "vibration"):
        assert flown in finding_of(rigid, effect, "contact-lost").sentence
    weak = loaded("pressure_off_the_cam")
    assert "flies" not in finding_of(weak, "contact-pressure", "contact-lost").sentence


@pytest.mark.parametrize("name", ["groove_lever", "conjugate_lever"])
def test_each_effect_says_where_a_clearance_is_crossed(name: str) -> None:
    held = loaded(name)
    flown = held.effect("lift-off").flight_ranges
    assert len(flown) == 4
    shown = [f"{math.degrees(start):.4f} to {math.degrees(end):.4f}" for start, end in flown]
    for effect in held.scene.effects:
        told = [f for f in held.effects.findings(effect) if f.name == "clearance-crossed"]
        assert len(told) == (effect in NEEDS_CONTACT), effect
        for each in told:
            assert each.severity == "warning"
            assert all(text in each.sentence for text in shown)
    assert finding_of(held, "contact-pressure", "largest-contact-pressure").severity == "ok"


def test_a_follower_that_stays_loses_nothing() -> None:
    for name in ("groove_lever", "valve_spring", "yoke", *(("press", "tappet") if LONG else ())):
        for effect in loaded(name).scene.effects:
            assert "contact-lost" not in names_of(loaded(name), effect)
            assert "trimmed-motion" not in names_of(loaded(name), effect)


def test_a_jump_of_the_velocity_away_from_the_cam_loses_contact() -> None:
    jumping = design(
        "straight_moves",
        "[effects.inertia]\nmass = 1\n[effects.spring]\nstiffness = 50\npreload = 1e4\n"
        "[effects.contact-pressure]",
        REFUSED,
    )
    lost = jumping.effect(CONTACT_FORCE).lost_contact
    assert lost.leaps
    assert not lost.ranges
    assert (
        "the velocity jumps away"
        in finding_of(jumping, "contact-pressure", "contact-lost").sentence
    )


# The demanded motion ------------------------------------------------------------------------------

SPRUNG: Final = (
    "[effects.kinematics]\n[effects.inertia]\nmass = 0.5\n[effects.spring]\nstiffness = 20\n"
    "preload = 2000\n[effects.contact-force]\nlimit = 1e5\n[effects.lift-off]\n"
    "[effects.drive-torque]\n[effects.contact-pressure]\nwidth = 5\n[effects.balance]\n"
)


@pytest.mark.parametrize("name", ["swallow_tail", "cut_lobe"])
def test_figures_of_a_trimmed_disc_are_of_the_motion_that_it_makes(name: str) -> None:
    trimmed = design(name, SPRUNG + "[effects.shock-spectrum]\n")
    outline = trimmed.cam.disc.outline("inner")
    replay = trimmed.cam.disc.replay("inner")
    ((start, end),) = outline.dropped
    for effect in trimmed.scene.effects:
        found_here = trimmed.effects.findings(effect)
        stated = [each for each in found_here if each.name == "trimmed-motion"]
        assert len(stated) == (effect != "balance"), effect
        for each in stated:
            assert (each.severity, each.cam_range) == ("warning", (start, end))
            assert f"{math.degrees(start):.4f} to {math.degrees(end):.4f}" in each.sentence
            assert each.value == replay.largest_loss.value
            moves = effect == "shock-spectrum"  # of the plan, whatever the disc does
            assert ("these figures are for the demanded motion" in each.sentence) == moves
            assert ("the acceleration jumps, which is computed" in each.sentence) == (not moves)
    forces = {each.name: each for each in trimmed.effects.findings("contact-force")}
    assert forces["largest-contact-force"].severity == "ok"
    spectra = trimmed.effects.findings("shock-spectrum")
    assert not [each for each in spectra if each.value is not None and each.severity == "ok"]


GROOVE: Final = (
    ("base_radius = 25", 'base_radius = 25\ncontact = "groove"'),
    ("thickness = 10", "thickness = 10\nrim = 90\ngroove_depth = 5"),
)


def test_a_scene_may_ask_for_the_motion_of_a_disc_that_is_not_made() -> None:
    asked = design(
        "swallow_tail",
        "[effects.kinematics]",
        REFUSED,
        ("[limits]", '[state]\nmotion = "outline"\n\n[limits]'),
    )
    stated = finding_of(asked, "kinematics", "trimmed-motion")
    assert "these figures are for the motion that the trimmed inner flank makes" in stated.sentence
    whole = design("swallow_tail", "[effects.kinematics]", REFUSED)
    assert asked.scene.made == whole.scene.made
    assert asked.scene.identity != whole.scene.identity


@pytest.mark.parametrize(
    "changes",
    [(REFUSED,), (("[limits]", '[state]\nmotion = "demanded"\n\n[limits]'),), GROOVE],
    ids=["refused", "stated", "groove"],
)
def test_where_the_disc_alone_does_not_tell_the_motion_figures_are_of_the_demanded_one(
    changes: tuple[tuple[str, str], ...],
) -> None:
    """A disc that is not made, the choice of the scene, and a groove with one of two flanks."""
    trimmed = design("swallow_tail", "[effects.kinematics]", *changes)
    stated = [
        each for each in trimmed.effects.findings("kinematics") if each.name == "trimmed-motion"
    ]
    assert stated
    assert all("these figures are for the demanded motion" in each.sentence for each in stated)
    assert finding_of(trimmed, "kinematics", "highest-velocity").severity == "warning"


def test_shocks_elsewhere_are_not_put_down_to_the_corner() -> None:
    """The velocity of straight moves jumps at 50 and 320 degrees, and their corners are others."""
    jumping = design("straight_moves", "[effects.kinematics]")
    stated = finding_of(jumping, "kinematics", "trimmed-motion")
    assert "shocks" not in stated.sentence
    assert stated.cam_range is None
    assert len(re.findall(r"\d to \d", stated.sentence)) == 2


def test_the_outer_flank_of_a_ring() -> None:
    ring = design("trimmed_ring", "[effects.load]\nconstant = 5")
    assert "trimmed outer flank" in finding_of(ring, "load", "trimmed-motion").sentence


# Better models of other effects ------------------------------------------------------------------


@pytest.mark.parametrize("name", TOGETHER)
def test_a_better_model_is_named_if_the_scene_has_it(name: str) -> None:
    whole = with_all(speed="stated")
    alone = name == "speed-fluctuation"  # no other effect follows the speed, nor it the train
    better = [each.effect for each in find_effect(name).refined_by if alone or not each.followed]
    refined = [each for each in better if each in TOGETHER]
    stated = [each for each in whole.effects.findings(name) if each.name == "simplified"]
    assert len(stated) == (1 if refined else 0)
    for each in stated:
        assert all(by in each.sentence for by in refined)
    assert name not in refined
    assert set(better) <= set(EFFECTS)


@pytest.mark.parametrize("name", TOGETHER)
def test_a_speed_that_is_found_is_not_simpler(name: str) -> None:
    whole = with_all()
    refined = [each.effect for each in find_effect(name).refined_by]
    stated = [each for each in whole.effects.findings(name) if each.name == "simplified"]
    assert all("speed-fluctuation" not in each.sentence for each in stated)
    assert ("found-speed" in names_of(whole, name)) == ("speed-fluctuation" in refined)


def test_what_depends_on_the_speed_of_the_cam_says_that_it_is_the_given_one() -> None:
    """All effects with the time course, except those that find it."""
    dependent = {"kinematics", "inertia", "contact-force", "lift-off", "drive-torque"}
    dependent |= {"contact-pressure", "vibration", "shock-spectrum", "spring-surge"}
    dependent |= {"reactions", "roller-spin", "balance", "power-balance"}
    for finder in FINDERS:
        stated = {
            name for name in EFFECTS
            if finder in [each.effect for each in find_effect(name).refined_by]
        }  # fmt: skip
        assert stated == dependent


# Figures in words ---------------------------------------------------------------------------------


ROUNDED: Final = re.compile(r"\de-(1[0-9]|[2-9][0-9])\b")
"""A number that only rounding leaves."""


@cache
def found(name: str, effect: str) -> tuple[Finding, ...]:
    return Design(load_scene(FIXTURES / "found" / f"{name}.toml")).effects.findings(effect)


def test_a_stress_without_a_strength_is_a_figure() -> None:
    spring = found("spring_stress_ok", "spring")
    for name, stress in (("largest-spring-stress", 1734.56), ("solid-spring-stress", 3709.37)):
        told = finding(spring, name)
        assert (told.value, told.verdict) == (pytest.approx(stress, rel=1e-5), "figure")
        assert "no strength of the wire is stated" in told.sentence
    assert finding(spring, "spring-index").verdict == "ok"
    assert finding(spring, "spring-buckling").verdict == "warning"


def test_a_sentence_that_nothing_limits_is_a_note() -> None:
    assert Finding("a", "ok", "b").verdict == "note"
    assert Finding("a", "ok", "b", 1.0).verdict == "figure"
    assert Finding("a", "ok", "b", 1.0, 2.0).verdict == "ok"
    assert Finding("a", "broken", "b", 1.0).verdict == "broken"


@pytest.mark.parametrize(
    ("hours", "asked", "words"),
    [
        (2.7e9, None, "bearing over 1,000,000 h"),
        (2.7e9, 2e4, "bearing over 1,000,000 h, at least 20000 h"),
        (2.7e9, 3e9, "bearing 2.7e+09 h, below 3e+09 h"),
        (31234.5, None, "bearing 31234.5 h"),
    ],
)
def test_a_life_of_more_than_a_century_is_not_told_in_figures(
    hours: float, asked: float | None, words: str
) -> None:
    steel = find_material("steel-hardened")
    life = None if asked is None else 3600.0 * asked
    data = PressureRequirements(steel, steel, 1500.0, rating=9000.0, life=life)
    told, *_ = life_findings(Life(1.0, 1.0, 3600.0 * hours, 0.0, 0.0, 0.0), data)
    assert told.sentence.endswith(words)
    assert told.value == pytest.approx(hours)


@pytest.mark.parametrize("angle", [0, 180])
def test_weights_across_the_guide_are_nothing(angle: int) -> None:
    """65 N at a right angle to the guide are no 4e-15 N along it; nor does any other effect say
    so."""
    guided = f"[effects.inertia]\nmass = 6.5\n[effects.gravity]\nangle = {angle}\n"
    tables = guided + "".join(
        f"[effects.{each}]\n" for each in ("contact-force", "reactions", "drive-torque")
    )
    made = design("plate_translating", tables)
    weight = finding(made.effects.findings("gravity"), "largest-weight-force")
    assert weight.value == 0.0
    assert "follower 0 N" in weight.sentence
    for name in made.scene.effects:
        for each in made.effects.findings(name):
            assert not ROUNDED.search(each.sentence), each


def test_no_speed_throws_off_what_has_no_mass() -> None:
    spring = "[effects.spring]\nstiffness = 2\npreload = 300\n[effects.lift-off]\n"
    told = finding(
        design("plate_translating", spring).effects.findings("lift-off"), "lift-off-speed"
    )
    assert (told.verdict, told.limit) == ("note", None)
    assert "states no mass" in told.sentence


def test_a_disturbance_that_is_gone_has_no_digits() -> None:
    assert remaining_share(0.0243) == "2.43 %"
    assert remaining_share(2.118e-21) == "less than 1e-06 %"


def test_rebounds_do_not_hide_impacts() -> None:
    """The two last crossings as a public report has them from a model of its own."""
    lift_off = found("rebounds_hide_impacts", "lift-off")
    impacts = [each for each in lift_off if each.name == "impact-speed"]
    assert len(impacts) == 4
    for each, (place, speed) in zip(impacts[2:], ((168.49, 33.12), (213.08, 33.21)), strict=True):
        assert each.cam_angle == pytest.approx(math.radians(place), abs=1e-4)
        assert each.value == pytest.approx(speed, abs=6e-3)
        assert "bounces 5 times" in each.sentence


def flight(leaving: float, speed: float, gap: float, *, rebound: bool, met: int = 1) -> Flight:
    return Flight(leaving, leaving + 0.1, gap, speed, 0.0, rebound, 1, met)


def test_a_rebound_that_is_more_than_its_flight_is_told_by_itself() -> None:
    first = flight(1.0, 5.0, 1.0, rebound=False)
    small = flight(1.1, 4.0, 0.5, rebound=True)
    for more in (replace(small, speed=6.0), replace(small, gap=2.0), replace(small, met=-1)):
        assert with_bounces((first, small, more)) == [[first, small], [more]]
    last = flight(6.2, 3.0, 1.0, rebound=False)
    passed = flight(0.05, 2.0, 0.5, rebound=True)
    assert with_bounces((passed, first, last)) == [[first], [last, passed]]


def test_flights_that_do_not_settle_have_a_reason() -> None:
    rough, fine = (Flights((flight(1.0, speed, 1.0, rebound=False),), 1) for speed in (99.0, 100.0))
    with pytest.raises(EffectError, match=UNSETTLED):
        refined(lambda _: (rough, replace(fine, turns=2)), lambda _: 0.0, 1e-6)
    with pytest.raises(EffectError, match=r"an error of 0\.02 relative to itself"):
        refined(lambda _: (rough, fine), lambda told: told[0].error, 1e-6)


@pytest.mark.long  # two seconds, and the sentence alone is new
def test_a_slider_that_turns_round_off_the_cam_is_told() -> None:
    told = [each for each in found("api_silent_ok", "lift-off") if "no landing" in each.sentence]
    assert len(told) == 1
    assert "reverses near cam angle 119 deg" in told[0].sentence
    assert "itself" not in told[0].sentence


def alike(count: int) -> list[Finding]:
    starts = np.radians(np.arange(count) * 360.0 / count).tolist()
    step = math.radians(360.0 / count)
    return [
        Finding("a", "broken", f"b{k}", -float(k % 7), 0.0, "N", start, (start, start + step / 2))
        for k, start in enumerate(starts)
    ]


def test_many_findings_alike_are_one_with_their_places() -> None:
    few = alike(MOST_ALIKE)
    assert folded(few) == tuple(few)
    other = Finding("c", "ok", "d")
    whole, *rest = folded([*alike(720), other])
    assert rest == [other]
    assert whole.value == -6.0
    assert whole.cam_angle == pytest.approx(math.radians(3.0))
    start = "b6; 720 such findings in all, at cam angles 0 to 0.25, 0.5 to 0.75,"
    assert whole.sentence.startswith(start)
    assert whole.sentence.endswith(" and 708 more deg")


def test_ranges_that_touch_are_told_as_one() -> None:
    step = math.radians(0.5)
    touching = [
        replace(each, cam_range=(k * step, (k + 1) * step)) for k, each in enumerate(alike(720))
    ]
    (whole,) = folded(touching[:700])
    assert whole.sentence == "b6; 700 such findings in all, at cam angles 0 to 350 deg"


# One verdict by every door ------------------------------------------------------------------------


LOOSE: Final = FIXTURES / "effects" / "pressure_off_the_cam.toml"
"""Its follower leaves the cam."""


@pytest.mark.parametrize("name", ["effects/pressure_off_the_cam", "effects/valve_spring"])
def test_no_door_says_otherwise(name: str) -> None:
    path = FIXTURES / f"{name}.toml"
    assert list(contradictions(str(path), path.read_text("utf-8"))) == []


@pytest.mark.parametrize("seed", [2, 8])
def test_no_door_says_otherwise_of_a_random_scene(seed: int) -> None:
    assert list(contradictions(*random_scene(Random(seed)), page=False)) == []


def test_an_effect_that_the_scene_does_not_name_tells_it_too() -> None:
    named = Design(load_scene(LOOSE))
    others = {each: dict(table) for each, table in named.scene.values["effects"].items()}
    del others["contact-pressure"]
    alone = Design(named.scene.with_values({"effects": others}))
    assert "drive-torque" not in alone.scene.effects
    assert alone.effect("drive-torque").findings[0].name == "contact-lost"


def test_findings_are_made_once_and_only_when_looked_at() -> None:
    made = design("setzhub", "[effects.inertia]\nmass = 1.0\n[effects.drive-torque]")
    result = made.effect("drive-torque")
    judged = "findings.effects.drive-torque"
    assert judged not in [each.name for each in made.ledger.runs]
    assert made.effects.findings("drive-torque") == tuple(result.findings)
    assert [each.name for each in made.ledger.runs].count(judged) == 1
