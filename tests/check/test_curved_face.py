"""Curved faces, against the tangent of a radial or offset follower in closed form."""

from __future__ import annotations

import math
import random
import re
from typing import Any

import numpy as np
import pytest
import tomlkit

import camgeo
from camgeo.check.finding import Finding
from tests.answers.documents import FIXTURES

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
