"""Inertia: Newton for single masses, energy for linkages, and equivalent bodies."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.dynamics.effects.effect import Subject
from camgeo.dynamics.effects.forces import at_rates
from camgeo.dynamics.effects.inertia import (
    LinkedTrain,
    Train,
    at_cam,
    inertia_force,
    reduced,
    train_of,
)
from camgeo.dynamics.effects.results import Inertia
from camgeo.dynamics.effects.tables import MassProperties
from camgeo.dynamics.effects.tables import parse_inertia as parse
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.effects.scenes import course_of, design
from tests.findings import finding
from tests.integrals import cells, integrals
from tests.strategies import SMOOTH, attack, plans, slider_cranks

ROUNDING = 1e-11
"""As a share of the largest value. The linkages drawn keep 2 mm from closing, so that by
sin(v - theta) >= 0.1 is divided twice, in rates of 1e-14; they keep off cos v = 0 by 0.05."""

PHI = np.linspace(0.0, TURN, 721)
STROKE = 8.0

TRANSLATING = "[effects.inertia]\nmass = 0.8\nroller_mass = 0.1\n"
ROCKER = "[effects.inertia]\nmoment_of_inertia = 0.02\nroller_mass = 0.1\n"
LINKED = (
    "[effects.inertia]\nmass = 1.5\nmoment_of_inertia = 0.02\nroller_mass = 0.1\n"
    "coupler_mass = 0.4\ncoupler_centre = 0.4\ncoupler_moment = 0.001\n"
)

MIRRORED = {
    "setzhub": (
        ("mirrored = false", "mirrored = true"),
        ('direction = "inward"', 'direction = "outward"'),
    ),
    "schnitt": (
        ("mirrored = false", "mirrored = true"),
        ('direction = "outward"', 'direction = "inward"'),
    ),
}
"""A mirrored linkage turns the rocker the other way."""


def inertia_of(scene: str, effects: str, *changes: tuple[str, str]) -> tuple[Inertia, Subject]:
    made = design(scene, effects, *changes)
    return made.effect("inertia"), made.effects.subject


def train_made(scene: str, effects: str) -> Train:
    made = design(scene, effects)
    return train_of(made.effects.subject, parse(made.effects.tables["inertia"]))


# Single masses --------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", ["plate_translating", "feed", "measured", "points"])
@pytest.mark.parametrize("side", ["right", "left"])
def test_a_translating_follower_obeys_newton(scene: str, side: Any) -> None:
    """-m (s'' omega^2 + s' alpha) [N], 0.9 kg; with a speed curve the latter is not to be lost."""
    result, subject = inertia_of(scene, TRANSLATING)
    rates, motion = course_of(subject).rates(PHI), subject.cam.drive.motion.jet(PHI, side)
    force = at_rates(result.force.coefficients(PHI, side), rates)
    expected = -0.9e-3 * in_time(motion, course_of(subject), PHI)[2]
    assert force == pytest.approx(expected, rel=1e-13, abs=1e-14 * np.max(np.abs(expected)))
    uneven = np.max(np.abs(0.9e-3 * motion[1] * rates[1]))
    assert (uneven > 0.01 * np.max(np.abs(force))) == (scene == "points")
    assert result.moved == pytest.approx(0.9e-3, rel=1e-15)
    assert result.to_follower(PHI, side) == pytest.approx(np.full(len(PHI), 0.9e-3), rel=1e-15)


def test_a_rocker_has_its_moment_and_the_roller_at_its_arm() -> None:
    """J + m l^2 = 0.02 kg m^2 + 0.1 kg (0.08 m)^2 = 0.02064 kg m^2 = 20.64 t mm^2."""
    result, subject = inertia_of("groove", ROCKER)
    assert result.moved == pytest.approx(20.64, rel=1e-14)
    assert finding(result.findings, "reduced-moment-of-inertia").value == pytest.approx(
        0.02064, rel=1e-14
    )
    jet = subject.cam.drive.motion.jet(PHI)
    coefficients = result.force.coefficients(PHI, "right")
    assert not np.any(coefficients[:2])
    assert coefficients[2:] == pytest.approx(-20.64 * jet[[2, 1]], rel=1e-14)


def test_without_any_mass_there_is_no_force() -> None:
    result, _ = inertia_of("setzhub", "[effects.inertia]\n")
    assert not np.any(result.force.coefficients(PHI, "right"))
    assert not np.any(at_cam(train_made("setzhub", "[effects.inertia]\n"), PHI, "right"))
    assert result.masses == ()
    assert all(each.value == 0.0 and math.isfinite(each.value) for each in result.findings)


# Linkages -------------------------------------------------------------------------------------


@st.composite
def trains(draw: st.DrawFn) -> LinkedTrain:
    """A linkage that keeps off both dead centres and cos v = 0, with masses of all kinds."""
    linkage = draw(slider_cranks(STROKE))
    pin, tip = linkage.joints(np.linspace(0.0, STROKE, 33))
    along = (pin - tip).real / linkage.coupler
    assume(np.all(np.abs(along) > 0.05) and np.all(along * along[0] > 0.0))
    spec = MassProperties(
        mass=draw(st.sampled_from([0.0, 1e-3, 2e-3])),
        coupler_mass=draw(st.sampled_from([0.0, 5e-4])),
        coupler_centre=draw(st.floats(0.0, 1.0)),
        coupler_moment=draw(st.sampled_from([None, 0.0, 3.0])),
    )
    return LinkedTrain(
        draw(plans(SMOOTH, STROKE)), linkage, draw(st.sampled_from([0.0, 5.0])), spec
    )


@attack
@given(train=trains())
def test_the_force_takes_from_the_kinetic_energy_what_it_gives(train: LinkedTrain) -> None:
    """At constant omega d(J/2)/dphi = -c2 q', integrated over cells; -c3 q' is J at every angle."""
    low, high = cells(train.output.borders, 6)

    def swing(phi: FloatArray) -> FloatArray:
        return np.asarray(train.linkage.transform(train.output.jet(phi), 1)[1])

    def at_cam(phi: FloatArray, side: Any) -> FloatArray:
        return np.asarray(sum(each.inertia * each.first**2 for each in train(phi, side)))

    def power(phi: FloatArray) -> FloatArray:
        return np.asarray(inertia_force(train, phi, "right")[2] * swing(phi))

    change = np.zeros(len(low)) + 0.5 * (at_cam(high, "left") - at_cam(low, "right"))
    inside = 0.5 * (low + high)
    size = np.max(np.abs(at_cam(inside, "right"))) if train(inside, "right") else 0.0
    assert np.all(np.abs(integrals(power, low, high) + change) <= ROUNDING * max(size, 1e-300))
    c3 = inertia_force(train, inside, "right")[3]
    assert np.all(np.abs(c3 * swing(inside) + at_cam(inside, "right")) <= ROUNDING * size)


@attack
@given(train=trains())
def test_a_coupler_is_worth_two_point_masses(train: LinkedTrain) -> None:
    """Masses (1 - lambda) m in the tip and lambda m in the pin have the same mass, centre and, if
    J_c = m lambda (1 - lambda) l_4^2, the same moment of inertia: the same force."""
    spec, linkage = train.data, train.linkage
    share, mass = spec.coupler_centre, 5e-4
    rigid = replace(
        spec,
        coupler_mass=mass,
        coupler_moment=mass * share * (1.0 - share) * linkage.coupler**2,
    )
    points = MassProperties(mass=spec.mass + share * mass)
    at_tip = train.inertia + (1.0 - share) * mass * linkage.crank**2
    first = replace(train, data=rigid)
    second = replace(train, data=points, inertia=at_tip)
    for side in ("right", "left"):
        forces = [inertia_force(each, PHI, side) for each in (first, second)]
        for one, other in zip(*forces, strict=True):
            assert one == pytest.approx(other, abs=ROUNDING * max(np.max(np.abs(other)), 1e-300))
        masses = [reduced(each, PHI, side) for each in (first, second)]
        assert masses[0] == pytest.approx(masses[1], rel=ROUNDING)


def test_a_coupler_without_a_moment_of_its_own_is_a_slender_rod() -> None:
    rod, subject = inertia_of("schnitt", "[effects.inertia]\ncoupler_mass = 0.6\n")
    linkage = subject.cam.drive.linkage
    assert linkage is not None
    moment = 0.6 * (linkage.coupler * 1e-3) ** 2 / 12.0  # kg m^2
    reported, _ = inertia_of(
        "schnitt", f"[effects.inertia]\ncoupler_mass = 0.6\ncoupler_moment = {moment!r}\n"
    )
    assert rod.to_follower(PHI, "right") == pytest.approx(
        reported.to_follower(PHI, "right"), rel=1e-14
    )


# Places ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("scene", ["setzhub", "schnitt"])
def test_places_and_their_ways_belong_together(scene: str, mirrored: bool) -> None:
    """dx/dphi = dx/dq q', integrated over cells."""
    changes = MIRRORED[scene] if mirrored else ()
    effects = f"{LINKED}rocker_mass = 0.7\nrocker_centre = [10, 20]\n"
    result, subject = inertia_of(scene, effects, *changes)
    assert [each.name for each in result.masses] == ["rocker", "roller", "slider", "coupler"]
    low, high = cells(subject.cam.drive.smooth_angles[:-1], 6)
    for mass in result.masses:

        def way(phi: FloatArray, mass: Any = mass) -> Any:
            return mass.per_lift(phi, "right") * subject.cam.drive.motion.jet(phi)[1]

        moved = mass.place(high, "left") - mass.place(low, "right")
        assert integrals(way, low, high) == pytest.approx(moved, abs=1e-11)
    assert result.masses[0].place(np.zeros(1), "right")[0] == pytest.approx(10 + 20j, abs=1e-12)


# What contradicts -----------------------------------------------------------------------------


def test_a_moment_too_small_for_its_mass_is_reported() -> None:
    """1 kg at 0.1 m from the pivot (-96, -72) has 0.01 kg m^2 at least."""
    text = "[effects.inertia]\nmoment_of_inertia = {}\nrocker_mass = 1\nrocker_centre = [4, -72]\n"
    result, _ = inertia_of("groove", text.format(0.0099))
    found = finding(result.findings, "rocker-moment-of-inertia")
    assert found.severity == "warning"
    assert (found.value, found.limit) == pytest.approx((0.0099, 0.01), rel=1e-14)
    result, _ = inertia_of("groove", text.format(0.01))
    assert "rocker-moment-of-inertia" not in [each.name for each in result.findings]
