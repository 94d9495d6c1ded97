"""Power of the camshaft against that of all forces and each loss, at any cam angle.

Every loss is a reaction times the velocity with which its parts rub, and none is the rest of the
sum: the bearing of the roller and the rolling on the flank, a face on its cam, the pivot under its
whole force, both ends of a guide. By the principle of virtual work (Norton, Cam Design and
Manufacturing Handbook, chapters on dynamics) the camshaft provides the sum.
"""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path
from random import Random
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.contact import INNER, OUTER, carrier, sliding
from camgeo.dynamics.effects.forces import at_rates, rates_of
from camgeo.errors import EffectError, GeometryError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.effects.test_pins import LINKED, drawn
from tests.long_form import examples

FORCES: Final = ("inertia", "gravity", "load", "spring")

FIXTURES: Final = [
    path
    for path in sorted((Path(__file__).parents[2] / "fixtures" / "effects").glob("*.toml"))
    if any(f"[effects.{force}]" in path.read_text("utf-8") for force in FORCES)
]
"""All scenes of effects that have a contact force."""

REST: Final = 1e-12
"""Largest residual of the balance, as a share of the largest power at any of the angles."""

STATED: Final = ("roller_pin", "rolling", "face", "pivot", "guide")


def rubbing(made: Design, table: dict[str, Any], phi: FloatArray) -> dict[str, FloatArray]:
    """(n,) power of each Coulomb loss by its name [N mm/s]."""
    bodies: Any = made.effect("reactions").bodies
    subject, contact = bodies.subject, bodies.contact
    omega = rates_of(subject, phi, "right")[0]
    normal = contact.normal(phi, "right")
    follower, rotation = subject.cam.follower, subject.cam.rotation
    found = {name: np.zeros(len(phi)) for name in STATED}
    for sense, here in ((INNER, normal >= 0.0), (OUTER, normal < 0.0)):
        if not np.any(here):
            continue
        disc, flank = carrier(subject, sense)
        relative = disc.state.curve.relative_jet(phi[here], "right", order=1)
        pace = np.hypot(relative.along[1], relative.across[1])
        force = np.abs(normal[here]) * omega[here]
        if disc.cam.follower.roller_radius > 0.0:
            on_cam = -flank * rotation * pace / disc.cam.follower.roller_radius
            on_pin = rotation + on_cam - relative.turning
            radius = 0.5 * table.get("roller_pin_diameter", 0.0)
            found["roller_pin"][here] = (
                table.get("roller_pin", 0.0) * radius * force * np.abs(on_pin)
            )
            found["rolling"][here] = table.get("rolling", 0.0) * force * np.abs(on_cam)
        if table.get("face", 0.0):
            slip = sliding(disc, phi[here], "right")
            found["face"][here] = table["face"] * force * np.abs(slip)
    speed = np.abs(subject.state.motion.jet(phi, "right", 1)[1]) * omega
    if follower.pivot is not None:
        lever = 0.5 * table.get("pivot", 0.0) * table.get("pivot_diameter", 0.0)
        found["pivot"] = lever * np.abs(bodies.of_pivot(phi, "right")) * speed
    else:
        ends = np.abs(bodies.of_guide(phi, "right"))
        found["guide"] = table.get("guide", 0.0) * np.sum(ends, axis=0) * speed
    return found


def behind_time(subject: Any, phi: FloatArray) -> FloatArray:
    """(n,) time [s] since cam angle 0."""
    course = subject.state.course
    return np.asarray(course.time(phi) - course.time(np.zeros(1)))


def powers(made: Design, table: dict[str, Any], phi: FloatArray) -> tuple[Any, dict[str, Any]]:
    """(n,) power of the camshaft, and what each force and each loss takes of it [N mm/s]."""
    result: Any = made.effect("drive-torque")
    subject: Any = made.effect("reactions").bodies.subject
    rates = rates_of(subject, phi, "right")
    rate = subject.state.motion.jet(phi, "right", 1)[1] * rates[0]
    taken = {
        each.name: -at_rates(each.coefficients(phi, "right"), rates) * rate
        for each in result.contact.forces
    }
    behind = result.contact.behind
    if behind is not None and behind.load is not None:  # it moves with the output, not the base
        pressed = behind.load.coefficients(phi, "right")[0]
        beyond = pressed * behind.response.states(behind_time(subject, phi), "right")[1]
        taken["load"] -= beyond
        taken["the elastic train"] += beyond
    return result.torque(phi, "right") * rates[0], {**taken, **rubbing(made, table, phi)}


def assert_told(made: Design, given: Any, taken: dict[str, Any], phi: FloatArray) -> None:
    """The columns of the effect are these powers."""
    told = {
        each.name: 1e3 * each.values(phi, "right") for each in made.effect("power-balance").columns
    }
    contact = sum(taken[name] for name in ("roller_pin", "rolling", "face"))
    own = {"drive power": given, **{f"power into {name}": each for name, each in taken.items()}}
    own |= {f"power lost {place}": contact for place in ("at the roller", "at the face")}
    own |= {f"power lost in the {name}": taken[name] for name in ("pivot", "guide")}
    largest = max(float(np.max(np.abs(each))) for each in (given, *taken.values()))
    for name, values in told.items():
        assert np.max(np.abs(values - own[name])) <= REST * largest, name
    whole = sum(each for name, each in told.items() if name != "drive power")
    assert np.max(np.abs(told["drive power"] - whole)) <= REST * largest


def assert_zero(given: Any, taken: dict[str, Any]) -> None:
    """Nothing is left of the power `given`; losses are never negative."""
    assert all(np.all(taken[name] >= 0.0) for name in STATED)
    largest = max(float(np.max(np.abs(each))) for each in (given, *taken.values()))
    assert np.max(np.abs(given - sum(taken.values()))) <= REST * largest


def assert_balanced(made: Design, table: dict[str, Any], phi: FloatArray) -> dict[str, Any]:
    """The parts of the power."""
    given, taken = powers(made, table, phi)
    assert_zero(given, taken)
    assert_told(made, given, taken, phi)
    return taken


def scene_with(text: str, *effects: str) -> str:
    """The scene with these effects, as empty tables where it does not have them."""
    named = tomllib.loads(text).get("effects", {})
    return text + "".join(f"\n[effects.{each}]\n" for each in effects if each not in named)


@pytest.mark.parametrize("path", FIXTURES, ids=lambda each: each.stem)
def test_the_power_of_the_camshaft_is_that_of_all_forces_and_losses(path: Path) -> None:
    text = scene_with(
        path.read_text("utf-8"), "contact-force", "drive-torque", "reactions", "power-balance"
    )
    phi = np.random.default_rng(7).uniform(0.0, TURN, 200)
    made = Design(parse_scene(text, str(path)))
    table = tomllib.loads(text)["effects"].get("friction", {})
    taken = assert_balanced(made, table, phi)
    for name in STATED:
        assert np.any(taken[name] > 0.0) == bool(table.get(name, 0.0)), name


def varied(rng: Random) -> str:
    """A scene of effects or a linked one with other masses, forces, friction and speed."""
    name = rng.choice([*LINKED, *(path.stem for path in FIXTURES)])
    if name in LINKED:
        return drawn(rng, name, rubbing=True)[0].replace("[effects.drive-torque]", "")
    text = (FIXTURES[0].parent / f"{name}.toml").read_text("utf-8")
    head, *tables = re.split(r"\n(?=\[effects|\[state|\[output)", text)
    kept = ("inertia", "gravity", "load", "spring", "friction")
    tables = [each for each in tables if each.startswith(tuple(f"[effects.{one}]" for one in kept))]

    def other(found: re.Match[str]) -> str:
        return f"{found[1]}{float(found[2]) * rng.uniform(0.3, 1.5):.6g}"

    numbers = r"(?m)^((?:mass|roller_mass|preload|constant|guide|pivot|face|roller_pin|rolling|"
    numbers += r"(?:guide|pivot)_viscous|angle|torsional_stiffness) = )(-?[0-9.]+)"
    changed = [re.sub(numbers, other, each) for each in tables]
    return "\n".join((re.sub(r"(?m)^(speed = )([0-9.]+)", other, head), *changed)) + "\n"


@settings(max_examples=examples(4, long=300), deadline=None)
@given(st.randoms(use_true_random=False))
def test_the_balance_of_random_mechanisms(rng: Random) -> None:
    text = scene_with(varied(rng), "contact-force", "drive-torque", "reactions")
    phi = np.random.default_rng(3).uniform(0.0, TURN, 100)
    try:
        made = Design(parse_scene(text, str(FIXTURES[0])))
        given, taken = powers(made, tomllib.loads(text)["effects"].get("friction", {}), phi)
    except (EffectError, GeometryError, SceneError):
        return  # a few followers jam
    assert_zero(given, taken)


LEVER: Final = (Path(__file__).parents[2] / "fixtures/effects/lever.toml").read_text("utf-8")


RIGID: Final = re.sub(r"\[effects\.vibration\][^\[]*", "", LEVER)
"""Without its train, which a load deflects."""


def found_of(text: str) -> dict[str, float]:
    """Values of the findings of `power-balance` by their names."""
    made = Design(parse_scene(scene_with(text, "power-balance"), "lever.toml"))
    found = made.effects.findings("power-balance")
    return {each.name: each.value for each in found if each.value is not None}


def test_the_efficiency_is_the_share_of_the_load() -> None:
    """A constant torque Q against a rise by h takes Q h whatever the law: without friction all that
    the drive provides.
    """
    load = "\n[effects.load]\nsegments = [0, 40, 0, 0]\n"
    none = RIGID.replace("[effects.friction]\npivot = 0.1\npivot_diameter = 20\n", "")
    assert len(none) < len(RIGID) < len(LEVER)
    smooth, rough = found_of(none + load), found_of(RIGID + load)
    for found in (smooth, rough):
        assert found["work-load"] == pytest.approx(40.0 * math.radians(16.0), rel=1e-6)
    assert smooth["efficiency"] == pytest.approx(1.0, rel=2e-6)
    lost = sum(rough[name] for name in rough if name.endswith("-friction"))
    share = rough["work-load"] / (rough["work-load"] + lost)
    assert rough["efficiency"] == pytest.approx(share, rel=4e-6)
