"""Figures of effects in words: what nothing limits is a figure, and rounding is 0."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np
import pytest

from camgeo.check.finding import MOST_ALIKE, Finding, folded
from camgeo.design.design import Design
from camgeo.dynamics.effects.contact_pressure import Life, life_findings
from camgeo.dynamics.effects.lift_off.flight import UNSETTLED, Flight, Flights, refined
from camgeo.dynamics.effects.lift_off.landing import with_bounces
from camgeo.dynamics.effects.tables import PressureRequirements
from camgeo.dynamics.effects.wording import left_over
from camgeo.errors import EffectError
from camgeo.part.materials import find_material
from camgeo.scene.scene import load_scene
from tests.draws.doors import FIXTURES
from tests.effects.scenes import design
from tests.findings import finding

ROUNDED: Final = re.compile(r"\de-(1[0-9]|[2-9][0-9])\b")
"""A number that only rounding leaves."""


@cache
def found(name: str, effect: str) -> tuple[Finding, ...]:
    return Design(load_scene(FIXTURES / "found" / f"{name}.toml")).effects.findings(effect)


def test_a_stress_without_a_strength_is_a_figure() -> None:
    spring = found("spring_stress_ok", "spring")
    for name, stress in (("largest-spring-stress", 1734.56), ("solid-spring-stress", 3709.37)):
        told = finding(spring, name)
        assert told.value == pytest.approx(stress, rel=1e-5)
        assert told.verdict == "figure"
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
    assert left_over(0.0243) == "2.43 %"
    assert left_over(2.118e-21) == "less than 1e-06 %"


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
    with pytest.raises(EffectError, match=r"an error of 0\.02 of itself"):
        refined(lambda _: (rough, fine), lambda told: told[0].error, 1e-6)


@pytest.mark.long  # two seconds, and the sentence alone is new
def test_a_slider_that_turns_round_off_the_cam_is_told() -> None:
    told = [each for each in found("api_silent_ok", "lift-off") if "no landing" in each.sentence]
    assert len(told) == 1
    assert "turns round near cam angle 119 deg" in told[0].sentence
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
    assert whole.sentence.startswith("b6; 720 alike in all, at cam angles 0 to 0.25, 0.5 to 0.75,")
    assert whole.sentence.endswith(" and 708 more deg")


def test_ranges_that_touch_are_told_as_one() -> None:
    step = math.radians(0.5)
    touching = [
        replace(each, cam_range=(k * step, (k + 1) * step)) for k, each in enumerate(alike(720))
    ]
    (whole,) = folded(touching[:700])
    assert whole.sentence == "b6; 700 alike in all, at cam angles 0 to 350 deg"
