"""Findings of flat and curved faces: convexity, jumps of the contact, the length of the face."""

from __future__ import annotations

import math
import random
import re
from dataclasses import replace
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
import tomlkit

import camgeo
from camgeo.check.disc import check_closure, check_convexity, check_face
from camgeo.check.finding import Finding
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.answers.documents import FIXTURES
from tests.findings import known
from tests.laws import LAWS
from tests.reference import plan_of

STROKE = 12.0


SPAN = math.radians(90.0)


PLAN = plan_of({"phi_H": [30, 90, 40, 90, 110]}, STROKE)


def only(findings: tuple[Finding, ...]) -> Finding:
    (found,) = findings
    return found


def whole_of(curve: PitchCurve) -> tuple[PitchCurve, Path]:
    """The curve, and all of it as the outline."""
    return curve, whole(WorkingCurve(curve, -0.0))


def tappet(base: float, face: tuple[float, float] | None = None) -> PitchCurve:
    return PitchCurve(PLAN, TranslatingFlat(base, face=face), 1)


def smallest_excess() -> float:
    """Smallest s + s'' of a rise: it is convex from a base radius on that makes up for it."""
    best = math.inf
    for k in range(20001):
        z = k / 20000.0
        lift = z**3 * (10.0 + z * (6.0 * z - 15.0))
        bend = 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z)
        best = min(best, STROKE * (lift + bend / SPAN**2))
    return best


def test_the_smallest_base_radius_is_where_it_says() -> None:
    least = -smallest_excess()
    found = only(check_convexity(tappet(40.0)))
    assert (found.name, found.severity, found.limit) == ("convexity", "ok", 0.0)
    assert found.value == pytest.approx(40.0 - least, abs=1e-6)
    short = only(check_convexity(tappet(least - 2.0)))
    assert short.severity == "no-disc"
    assert "undercut" in short.sentence
    assert "make follower.base_radius larger" in short.sentence
    assert short.value is not None
    mended = only(check_convexity(tappet(least - 2.0 - short.value * (1.0 + 1e-6))))
    assert mended.severity == "ok"
    cusp = only(check_convexity(tappet(least - 2.0 - short.value)))
    assert cusp.severity == "no-disc"
    assert "cusp" in cusp.sentence


def test_a_rocker_is_mended_by_both() -> None:
    plan = plan_of({"phi_H": [30, 60, 80, 120, 70]}, math.radians(12.0))
    follower = OscillatingFlat(complex(-70.0, 50.0), 35.0, 8.0, 1, 1)
    found = only(check_convexity(PitchCurve(plan, follower, -1)))
    assert found.severity == "no-disc"
    assert "follower.base_radius and follower.face_offset both" in found.sentence
    more = -known(found.value) + 1e-6
    larger = replace(follower, base_radius=35.0 + more, face_offset=8.0 + more)
    assert only(check_convexity(PitchCurve(plan, larger, -1))).value == pytest.approx(
        1e-6, rel=1e-3
    )


def test_a_face_that_turns_back() -> None:
    """The rocker turns with the cam and faster: chi' = 1.875 psi_H / span > 1."""
    plan = plan_of({"phi_H": [30, 130, 10, 120, 70]}, 1.9)
    follower = OscillatingFlat(-400.0 + 0j, 60.0, 0.0, 1, 1)
    found = only(check_convexity(PitchCurve(plan, follower, -1)))
    assert found.severity == "no-disc"
    assert "turns back" in found.sentence
    assert found.value == pytest.approx(1.0 - 1.875 * 1.9 / math.radians(120.0), abs=1e-9)


def test_a_shock_makes_the_contact_jump() -> None:
    law = LAWS["straight-line"]
    plan = MotionPlan(
        (Dwell(Decimal(90)), Move(Decimal(90), 10.0, law), Move(Decimal(180), 0.0, law))
    )
    curve = PitchCurve(plan, TranslatingFlat(60.0), 1)
    found = {finding.name: finding for finding in check_convexity(curve)}["contact-jump"]
    assert found.severity == "no-disc"
    # From 10/(pi/2) up to 10/pi down, at the top; ahead at both ends of the rest.
    assert found.value == pytest.approx(-30.0 / math.pi)
    assert found.cam_angle == pytest.approx(math.pi)
    assert "3 jumps" in found.sentence


def test_whatever_does_not_close_is_a_jump_of_the_contact() -> None:
    """However slight the shock, which the closure of the curve does not show."""
    law = LAWS["straight-line"]
    for stroke in (1e-12, 1e-11, 1e-10, 1e-9, 1e-6):
        moves = (Move(Decimal(90), stroke, law), Move(Decimal(180), 0.0, law))
        curve = PitchCurve(MotionPlan((Dwell(Decimal(90)), *moves)), TranslatingFlat(60.0), 1)
        closure = next(each for each in check_closure(curve) if each.name == "closure")
        reported = {each.name for each in check_convexity(curve) if each.severity == "no-disc"}
        assert closure.severity == "ok" or reported == {"contact-jump"}


def test_a_face_over_the_cam_axis() -> None:
    """An eccentric: a circle of 20 mm whose centre is 25 mm from the axis is convex, and no cam."""
    plan = MotionPlan(
        (
            Move(Decimal(180), 50.0, LAWS["simple-sine"]),
            Move(Decimal(180), 0.0, LAWS["simple-sine"]),
        )
    )
    curve = PitchCurve(plan, TranslatingFlat(45.0, direction=-1), 1)
    found = {finding.name: finding for finding in check_convexity(curve)}
    assert found["convexity"].value == pytest.approx(20.0)
    assert found["face-over-axis"].severity == "no-disc"
    assert found["face-over-axis"].value == pytest.approx(-5.0)


def test_the_face_is_as_long_as_the_velocity_says() -> None:
    """x = s' (1.875 H / span up and down), also of the other sense: its mirror."""
    reach = 1.875 * STROKE / SPAN
    found = only(check_face(*whole_of(tappet(40.0))))
    assert found.value == pytest.approx(2.0 * reach)
    assert f"{2.0 * reach:.6g} mm is needed" in found.sentence
    slack = only(check_face(*whole_of(tappet(40.0, (-reach - 1.0, reach + 0.5)))))
    assert (slack.severity, slack.limit) == ("ok", reach + 0.5)
    short = only(check_face(*whole_of(tappet(40.0, (-reach + 0.25, reach + 0.5)))))
    assert short.severity == "broken"
    assert short.value == pytest.approx(-reach)
    assert short.limit == pytest.approx(-reach + 0.25)
    assert short.cam_angle == pytest.approx(math.radians(205.0))
    assert "0.25 mm too short" in short.sentence


def test_a_contact_at_the_foot_of_the_pivot_has_no_lever() -> None:
    """A rocker that swings until its face stands square on the line of centres, and beyond."""
    plan = plan_of({"phi_H": [30, 130, 10, 120, 70]}, math.radians(40.0))
    follower = OscillatingFlat(-90.0 + 0j, 90.0 * math.sin(math.radians(60.0)), 0.0, 1, 1)
    checked = check_face(*whole_of(PitchCurve(plan, follower, 1)))
    found = {finding.name: finding for finding in checked}
    assert found["face-length"].severity == "ok"
    assert found["contact-lever"].severity == "broken"
    assert known(found["contact-lever"].value) < 0.0


STEP = math.radians(0.005)
"""Of the grid [rad]; a parabola through three of its points is off by far less than `OFF`."""


OFF = 1e-6
"""Of places along a face [mm]."""


def by_name(design: camgeo.Design) -> dict[str, Finding]:
    return {each.name: each for each in design.findings}


def scene(source: random.Random) -> dict[str, Any]:
    radius, base = source.uniform(200.0, 2000.0), source.uniform(17.0, 20.0)
    span = float(source.randint(90, 120))
    lift = {"law": "polynomial-4567", "span": span, "to": source.uniform(1.0, 3.0)}
    return {
        "camgeo": 1,
        "name": "curved",
        "cam": {"rotation": source.choice(["cw", "ccw"])},
        "follower": {
            "kind": "translating-roller",
            "base_radius": base + radius,
            "roller_radius": radius,
            "offset": source.choice([0.0, source.uniform(-3.0, 3.0)]),
        },
        "motion": [lift, {**lift, "to": 0.0}, {"dwell": 360.0 - 2.0 * span}],
    }


def run(values: dict[str, Any]) -> tuple[float, float]:
    """Lowest and highest place of the contact [mm], to the right of the middle of the face.

    Seen from the cam the centre e + i h(phi) moves across its path at h, and along it at h' in the
    sense of the turn, less e: the normal leans by the angle between both.
    """
    follower, motion = values["follower"], values["motion"]
    span, to = math.radians(motion[0]["span"]), motion[0]["to"]
    x = np.arange(0.0, 1.0, STEP / span)
    s = to * x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3)
    ds = to / span * 140.0 * x**3 * (1.0 - x) ** 3
    offset, radius = follower["offset"], follower["roller_radius"]
    sense = 1.0 if values["cam"] == {"rotation": "ccw"} else -1.0
    height = math.sqrt(follower["base_radius"] ** 2 - offset**2) + s
    places = [
        radius * along / np.hypot(along, height)
        for along in (sense * ds - offset, -sense * ds - offset)
    ]
    found = np.concatenate(places)
    low, high = float(np.min(found)), float(np.max(found))
    return -_peak(-found, -low), _peak(found, high)


def _peak(values: np.ndarray, most: float) -> float:
    """The top of the parabola about the largest of `values`."""
    k = int(np.argmax(values))
    before, after = values[k - 1], values[(k + 1) % len(values)]
    bend = before - 2.0 * most + after
    return most if bend == 0.0 else float(most - (after - before) ** 2 / (8.0 * bend))


def test_the_rule_for_rollers_is_not_for_a_curved_tappet() -> None:
    design = camgeo.load(FIXTURES / "found" / "curved_tappet.toml")
    found = by_name(design)
    assert {each.severity for each in design.findings} == {"ok"}
    assert found["radius-ratio-inner"].limit is None
    assert "the cam is convex" in found["convexity"].sentence
    assert found["convexity"].value == pytest.approx(401.6358 - 400.0, abs=5e-5)
    # +-8 mm in the report: r_R cos 88.8616 deg, its smallest transmission angle.
    assert found["face-length"].value == pytest.approx(
        800.0 * math.cos(math.radians(88.8616)), abs=800.0 * math.radians(5e-5)
    )
    stated = camgeo.Design(design.scene.with_values({"limits.radius_ratio": 0.8}))
    assert by_name(stated)["radius-ratio-inner"].severity == "broken"
    roller = camgeo.Design(design.scene.with_values({"follower.base_radius": 450}))
    assert by_name(roller)["radius-ratio-inner"].severity == "broken"
    assert "face-length" not in by_name(roller)


@pytest.mark.parametrize("seed", range(6))
def test_the_run_of_the_contact(seed: int) -> None:
    values = scene(random.Random(seed))
    found = by_name(camgeo.loads(tomlkit.dumps(values)))["face-length"]
    low, high = run(values)
    assert found.value == pytest.approx(high - low, abs=OFF)
    told = [float(each) for each in re.findall(r"(\S+) mm", found.sentence)]
    right = [low, high, high - low, 2.0 * max(-low, high)]
    assert told == pytest.approx(right, rel=1e-5, abs=OFF)


@pytest.mark.parametrize("seed", range(4))
def test_the_spring_that_would_hold_a_lost_contact_is_told(seed: int) -> None:
    """On a guide without friction N >= 0 where m s'' omega^2 + P + c s >= 0."""
    source = random.Random(seed)
    values = scene(source)
    values["follower"]["offset"] = 0.0
    speed, mass, preload, rate = source.uniform(1000.0, 3000.0), 0.3, 5.0, 2.0
    values["cam"] = {"rotation": "cw", "speed": speed}
    values["effects"] = {
        "inertia": {"mass": mass},
        "spring": {"preload": preload, "stiffness": rate},
        "contact-force": {},
    }
    first = values["motion"][0]
    span, to = math.radians(first["span"]), first["to"]
    x = np.arange(0.0, 1.0, 0.1 * STEP / span)
    s = to * x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3)
    acceleration = to / span**2 * 420.0 * x**2 * (1.0 - x) ** 2 * (1.0 - 2.0 * x)
    inertia = 1e-3 * mass * acceleration * (speed * math.tau / 60.0) ** 2
    least = float(np.max(-inertia - rate * s))
    stiffest = float(np.max((-inertia[1:] - preload) / s[1:], where=s[1:] > 1e-3, initial=0.0))
    findings = camgeo.loads(tomlkit.dumps(values)).effects.findings("contact-force")
    lost = next(each for each in findings if each.name == "contact-lost")
    told = [float(each) for each in re.findall(r"(?:preload|stiffness) of (\S+)", lost.sentence)]
    assert told == pytest.approx([least, stiffest], rel=2e-5)
    for key, value in (("preload", told[0]), ("stiffness", told[1])):
        for factor, held in ((1.0, True), (1.0 - 1e-4, False)):
            scene_ = camgeo.loads(tomlkit.dumps(values)).scene
            changed = scene_.with_values({f"effects.spring.{key}": factor * value})
            names = [each.name for each in camgeo.Design(changed).effects.findings("contact-force")]
            assert ("contact-lost" not in names) == held
