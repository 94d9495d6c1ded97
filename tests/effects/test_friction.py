from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Request, Results
from camgeo.dynamics.effects.friction import parse
from camgeo.dynamics.effects.friction.result import Statics, compute, statics_of
from camgeo.dynamics.effects.results import Friction
from camgeo.dynamics.state.state import Demanded
from camgeo.errors import EffectError, GeometryError
from camgeo.kinematics.mechanism.linkage import locked_at
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import grid_of
from camgeo.units import TURN
from tests.effects.scenes import assert_refused, design
from tests.findings import effect_findings

ROLLER: Final = {"roller_pin": 0.08, "roller_pin_diameter": 7.0, "rolling": 0.06}
GUIDE: Final = {"guide": 0.17, "guide_length": 45.0, "guide_overhang": 8.0}
PIVOT: Final = {"pivot": 0.13, "pivot_diameter": 24.0}

TURNED: Final = {"ccw": ('rotation = "ccw"', 'rotation = "cw"'),
                 "cw": ('rotation = "cw"', 'rotation = "ccw"')}  # fmt: skip

SCENES: Final = {
    "plate_translating": ("ccw", GUIDE),
    "ring": ("ccw", GUIDE),
    "groove": ("cw", PIVOT),
    "shuttle": ("cw", PIVOT),
}

LARGE: Final = {
    "plate_translating": (10, 55),
    "ring": (8, 62),
    "groove": (10, 95),
    "shuttle": (10, 70),
}
"""Radii of the rollers, and radii between the smallest and the largest |Z'|."""


def friction(made: Any, **table: float) -> Friction:
    return compute(Request(made.effects.subject, parse(table), Results({}), 1e-6))


def statics(made: Any, **table: float) -> Statics:
    return statics_of(made.effects.subject, parse(table))


def angles(made: Design) -> FloatArray:
    """Between the borders of the motion."""
    return grid_of(made.drive.smooth_angles).ravel()


class Bodies:
    """Cam, roller and follower of a design in the fixed frame, as vectors, per unit cam speed."""

    def __init__(self, made: Design, phi: FloatArray, sense: int) -> None:
        sigma, follower = made.cam.rotation, made.cam.follower
        curve = made.cam.disc.pitch_curve.jet(phi)
        to_frame = np.exp(1j * sigma * phi)
        self.sigma = sigma
        self.centre: ComplexArray = curve[0] * to_frame
        self.velocity: ComplexArray = (curve[1] + 1j * sigma * curve[0]) * to_frame
        self.tangent: ComplexArray = curve[1] / np.abs(curve[1]) * to_frame
        self.normal: ComplexArray = 1j * sigma * self.tangent
        self.arm: ComplexArray = -sense * follower.roller_radius * self.normal
        self.turning = np.zeros(len(phi))
        if isinstance(follower, OscillatingRoller):
            self.turning = np.imag(self.velocity / (self.centre - follower.pivot))
        # The roller's material goes with the cam's at the contact.
        of_cam = 1j * sigma * (self.centre + self.arm)
        rate = (of_cam - self.velocity) / (1j * self.arm)
        assert np.max(np.abs(rate.imag)) <= 1e-12 * np.max(np.abs(rate.real))
        self.roller: FloatArray = rate.real


def reactions(made: Design, table: dict[str, float], at: Bodies, load: ComplexArray,
              moment: FloatArray) -> FloatArray:  # fmt: skip
    """Sum of the magnitudes of both reactions of the guide, by its equations of balance."""
    assert isinstance(made.cam.follower, TranslatingRoller)
    out = np.exp(1j * made.cam.follower.guide_angle)
    side = np.real(load * np.conj(-1j * out))
    first = np.real(made.cam.disc.pitch_curve.jet(np.zeros(1))[0] * np.conj(out))[0]
    height = np.real(at.centre * np.conj(out))
    near = first + table["guide_overhang"]
    far = near + table["guide_length"]
    found = []
    for y, s, m in zip(height, side, moment, strict=True):
        # Forces to the right at heights y, near, far: their sum, and their moment, vanish.
        rows = np.array([[1.0, 1.0], [-near, -far]])
        found.append(np.sum(np.abs(np.linalg.solve(rows, [-s, y * s - m]))))
    return np.array(found)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("changes", [*range(3)])
@pytest.mark.parametrize("scene", SCENES)
def test_the_power_balance_closes(scene: str, changes: int, sense: int) -> None:
    """What the cam takes is what the follower gets, and what is lost in each of the bearings.

    As it is; turned the other way; and with a roller so large that on the inner flank it changes
    the sense in which it turns on its pin.
    """
    rotation, own = SCENES[scene]
    radius, large = LARGE[scene]
    change = [TURNED[rotation], (f"roller_radius = {radius}\n", f"roller_radius = {large}\n")]
    made = design(scene, "", *change[changes - 1 : changes] if changes else ())
    table = {**own, **ROLLER}
    found = friction(made, **table)
    phi = angles(made)
    at = Bodies(made, phi, sense)
    leverage, slope = made.cam.disc.pitch_curve.leverage(phi), made.cam.drive.motion.jet(phi)[1]
    force, torque = found.per_normal(phi, "right", sense)
    taken = sense * leverage * slope + torque
    given = (sense * leverage + force) * slope

    spin, against_cam = at.roller - at.turning, at.roller - at.sigma
    assert (np.min(spin) * np.max(spin) < 0.0) == (changes == 2 and sense == 1)
    pin = -0.5 * table["roller_pin"] * table["roller_pin_diameter"] * np.sign(spin)
    rolling = -table["rolling"] * np.sign(against_cam)
    # Balance of moments of the roller: Im(conj(arm) f t) + pin + rolling = 0.
    tangential = -(pin + rolling) / np.imag(np.conj(at.arm) * at.tangent)
    load = sense * at.normal + tangential * at.tangent
    if isinstance(made.cam.follower, OscillatingRoller):
        held = np.abs(load)  # with no load but the contact
        lost = 0.5 * table["pivot"] * table["pivot_diameter"] * held * np.abs(at.turning)
    else:
        carried = reactions(made, table, at, load, -pin)
        lost = table["guide"] * carried * np.abs(at.velocity)
    dissipated = lost - pin * spin - rolling * against_cam
    assert np.all(dissipated >= 0.0)
    # Some hundred roundings of the powers and of what they are made of, the roller's rates.
    scale = np.max(np.abs(taken)) + np.max(np.abs(at.roller))
    assert np.max(np.abs(taken - given - dissipated)) <= 1e-13 * scale

    # And each of the two by itself: what the forces on the follower do, and those on the cam.
    on_follower = np.real(load * np.conj(at.velocity)) - pin * at.turning - lost
    assert np.max(np.abs(given - on_follower)) <= 1e-13 * scale
    lever = np.imag(np.conj(at.centre + at.arm) * load)
    assert np.max(np.abs(taken - at.sigma * (lever + rolling))) <= 1e-13 * scale


MIRRORS: Final = {
    "plate_translating": [TURNED["ccw"], ("offset = 12", "offset = -12")],
    "groove": [
        TURNED["cw"],
        ("pivot = [-96, -72]", "pivot = [96, -72]"),
        ('arm_side = "ccw"', 'arm_side = "cw"'),
    ],
}


@pytest.mark.parametrize("scene", MIRRORS)
def test_a_mirrored_design_has_the_same_friction(scene: str) -> None:
    made, mirrored = design(scene, ""), design(scene, "", *MIRRORS[scene])
    table = {**SCENES[scene][1], **ROLLER}
    first, second = friction(made, **table), friction(mirrored, **table)
    phi = angles(made)
    for sense in (1, -1):
        here, there = (each.per_normal(phi, "right", sense) for each in (first, second))
        assert here == pytest.approx(there, abs=1e-12 * float(np.max(np.abs(here))))
        one, other = (
            statics(each, **table).margin(phi, "right", sense) for each in (made, mirrored)
        )
        assert one == pytest.approx(other, abs=1e-12)


@pytest.mark.parametrize("overhang", [30.0, 8.0, 1e-9])
def test_guide_friction_by_the_largest_pressure_angle(overhang: float) -> None:
    """tan alpha = b / (mu (2 a + b)) with a > 0 (Rothbart, Cam Design Handbook, chapter 6).

    The overhang shrinks by up to 20 mm as the roller goes out: from 8 mm it comes between the ends
    of the guide, which then carries the side force alone, mu for mu (2 a + b) / b.
    """
    made = design("plate_translating", "")
    length, coefficient = 45.0, 0.17
    table = {"guide": coefficient, "guide_length": length, "guide_overhang": overhang}
    found = friction(made, **table)
    phi = angles(made)
    lift, slope = made.cam.drive.motion.jet(phi)[:2]
    a = overhang - lift
    lever = np.where(a >= 0.0, (2.0 * a + length) / length, 1.0)
    largest = np.arctan2(1.0, coefficient * lever)
    wanted = largest - made.cam.disc.pitch_curve.pressure_angle(phi)
    assert statics(made, **table).margin(phi, "right", 1) == pytest.approx(wanted, abs=1e-12)
    force, torque = found.per_normal(phi, "right", 1)
    side = np.sin(made.cam.disc.pitch_curve.pressure_angle(phi))
    assert force == pytest.approx(-np.sign(slope) * coefficient * lever * side, abs=1e-13)
    assert np.all(torque == 0.0)
    (margin,) = found.findings
    assert margin.value == pytest.approx(math.degrees(np.min(wanted[slope > 0.0])), abs=1e-3)


HELD_BOTH_WAYS: Final = {
    "groove_clearance": "guide = 0.3\nguide_length = 45\nguide_overhang = 40",
    "conjugate_carriage": "guide = 0.6",
    "groove": "pivot = 0.6\npivot_diameter = 50",
    "conjugate_lever": "pivot = 0.6\npivot_diameter = 50",
}


@pytest.mark.parametrize("scene", HELD_BOTH_WAYS)
def test_the_margin_is_of_the_flank_that_pushes_if_there_are_two(scene: str) -> None:
    """A flank that pushes may lean as far as the guide allows, or until its force passes the pivot
    at mu r; the inner or main one drives outward, the other one inward.
    """
    made = design(scene, f"[effects.friction]\n{HELD_BOTH_WAYS[scene]}\n")
    follower, found = made.cam.follower, made.effect("friction")
    assert isinstance(follower, (TranslatingRoller, OscillatingRoller))
    phi = np.linspace(0.0, TURN, 4000, endpoint=False) + 1e-4
    lift, slope = made.cam.drive.motion.jet(phi)[:2]
    returning = made.effects.subject.returning
    centre = made.cam.disc.pitch_curve
    angle = centre.pressure_angle(phi)
    if returning is not None:
        angle = np.where(slope > 0.0, angle, returning.state.curve.pressure_angle(phi))
    if isinstance(follower, TranslatingRoller):
        lever = (2.0 * (40.0 - lift) + 45.0) / 45.0 if scene == "groove_clearance" else 1.0
        largest = np.arctan2(1.0, (0.3 if scene == "groove_clearance" else 0.6) * lever)
    else:
        arm = np.full(phi.shape, abs(follower.start_arm))
        if returning is not None:
            arm = np.where(slope > 0.0, arm, abs(returning.state.curve.follower.start_arm))
        largest = np.arccos(0.6 * 25.0 / arm)
    moving = np.abs(slope) > 1e-6
    (column,) = (each for each in found.columns if each.name == "jamming margin")
    own = np.degrees(largest - angle)
    assert column.values(phi, "right")[moving] == pytest.approx(own[moving], abs=1e-9)
    (margin,) = (each for each in found.findings if each.name == "jamming-margin")
    worst = int(np.argmin(np.where(moving, own, np.inf)))
    assert margin.value == pytest.approx(own[worst], abs=1e-3)
    assert margin.cam_angle == pytest.approx(phi[worst], abs=math.radians(1.0))


def test_a_roller_centre_beyond_the_far_end_of_the_guide() -> None:
    """b = 5 mm: at the top the guide lies 10 to 15 mm on this side of the roller's centre."""
    made = design("plate_translating", "")
    found = statics(made, guide=0.1, guide_length=5.0, guide_overhang=5.0)
    phi = np.radians([150.0])
    force = found.drag(found.state(phi, "right", 1))
    side = np.sin(made.cam.disc.pitch_curve.pressure_angle(phi))
    assert force == pytest.approx(0.1 * side * (15.0 + 10.0) / 5.0, rel=1e-12)


def test_without_a_length_the_guide_carries_the_side_force() -> None:
    made = design("ring", "")
    found = friction(made, guide=0.2)
    phi = angles(made)
    slope = made.cam.drive.motion.jet(phi)[1]
    side = np.sin(made.cam.disc.pitch_curve.pressure_angle(phi))
    force = found.per_normal(phi, "right", -1)[0]
    assert force == pytest.approx(-0.2 * np.sign(slope) * side, abs=1e-14)


@pytest.mark.parametrize(
    ("share", "severity"), [(0.5, "ok"), (0.97, "warning"), (0.999, "warning"), (1.001, "broken")]
)
def test_the_coefficient_at_which_the_follower_jams(share: float, severity: str) -> None:
    """mu = b / ((2 a + b) tan alpha), smallest over the rise, found on a fine grid."""
    made = design("plate_translating", "")
    length, overhang = 30.0, 60.0
    low, high = math.radians(30.0), math.radians(130.0)
    phi = np.linspace(low + 1e-9, high, 200_001)
    lever = (2.0 * (overhang - made.cam.drive.motion.jet(phi)[0]) + length) / length
    largest = 1.0 / (lever * np.tan(made.cam.disc.pitch_curve.pressure_angle(phi)))
    worst = int(np.argmin(largest))
    coefficient = float(largest[worst]) * share
    table = {"guide": coefficient, "guide_length": length, "guide_overhang": overhang}
    found = friction(made, **table)
    (margin,) = found.findings
    assert margin.name == "jamming-margin"
    assert margin.severity == severity
    assert margin.cam_angle is not None
    if share >= 0.97:
        assert margin.cam_angle == pytest.approx(float(phi[worst]), abs=math.radians(5.0))
    if severity == "broken":
        assert margin.value is not None
        assert margin.value < 0.0
        assert margin.limit == 0.0
        assert margin.cam_range is not None
        first, last = margin.cam_range
        assert first <= phi[worst] <= last
        inside = (phi > first + 1e-6) & (phi < last - 1e-6)
        outside = (phi < first - 1e-6) | (phi > last + 1e-6)
        assert np.all(largest[inside] < coefficient)
        assert np.all(largest[outside] > coefficient)


shares = st.floats(0.0, 1.5)


@settings(max_examples=40, deadline=None)
@given(
    scene=st.sampled_from(sorted(SCENES)),
    rotation=st.booleans(),
    own=shares,
    overhang=st.floats(0.001, 200.0),
    pin=shares,
    rolling=st.floats(0.0, 2.0),
)
def test_no_margin_is_where_no_normal_force_moves_the_follower(
    scene: str, rotation: bool, own: float, overhang: float, pin: float, rolling: float
) -> None:
    """The margin is above 0 where a push leaves something of itself, after all friction."""
    made = MADE[scene, rotation]
    table = {"roller_pin": pin, "roller_pin_diameter": 7.0, "rolling": rolling}
    if isinstance(made.cam.follower, OscillatingRoller):
        table |= {"pivot": own, "pivot_diameter": 40.0}
    else:
        table |= {"guide": own, "guide_length": 40.0, "guide_overhang": overhang}
    found = friction(made, **table)
    phi = angles(made)[::7]
    slope, leverage = made.cam.drive.motion.jet(phi)[1], made.cam.disc.pitch_curve.leverage(phi)
    reach = abs(made.cam.follower.reach)
    for sense in (1, -1):
        driven = sense * leverage * slope > 0.0
        force = found.per_normal(phi, "right", sense)[0]
        left = (sense * leverage + force) * np.sign(slope) / reach
        margin = statics(made, **table).margin(phi, "right", sense)
        clear = driven & (np.abs(left) > 1e-9)
        assert np.all((margin[clear] > 0.0) == (left[clear] > 0.0))


MADE: Final = {
    (scene, turned): design(scene, "", *([TURNED[sense]] if turned else []))
    for scene, (sense, _) in SCENES.items()
    for turned in (False, True)
}


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("scene", SCENES)
def test_the_margin_ends_at_the_coefficient_that_takes_all(scene: str, sense: int) -> None:
    """Coefficient by coefficient: what a push leaves is linear in that of the guide or pivot."""
    made = MADE[scene, False]
    key = "pivot" if isinstance(made.cam.follower, OscillatingRoller) else "guide"
    table = {**SCENES[scene][1], **ROLLER, key: 0.0}
    without = statics(made, **table)

    def with_coefficient(value: float) -> Statics:
        return replace(without, data=parse({**table, key: value}))

    unit = with_coefficient(1.0)
    phi = angles(made)[3::7]
    leverage, slope = made.cam.disc.pitch_curve.leverage(phi), made.cam.drive.motion.jet(phi)[1]
    phi = phi[sense * leverage * slope > 0.0]
    assert len(phi) > 5
    push = np.sign(made.cam.drive.motion.jet(phi)[1])
    sine = sense * made.cam.disc.pitch_curve.leverage(phi)
    free, taken = ((sine + each.per_normal(phi, "right", sense)[0]) * push
                   for each in (without, unit))  # fmt: skip
    for angle, coefficient in zip(phi, free / (free - taken), strict=True):
        jammed = with_coefficient(float(coefficient))
        margin = jammed.margin(np.array([angle]), "right", sense)
        # Hundreds of roundings of terms of order 1; near a transmission angle of 90 degrees the
        # arc cosine of a share near 1, which a pivot can take, has half the digits.
        assert margin == pytest.approx([0.0], abs=1e-7 if key == "pivot" else 1e-13)


def test_pivot_friction_by_its_circle() -> None:
    """The follower jams where the normal passes the pivot within mu d / 2."""
    made = design("shuttle", "")
    found = statics(made, pivot=0.2, pivot_diameter=40.0)
    phi = angles(made)
    wanted = made.cam.disc.pitch_curve.transmission_angle(phi) - math.asin(0.2 * 20.0 / 90.0)
    assert found.margin(phi, "right", 1) == pytest.approx(wanted, abs=1e-12)
    force = found.per_normal(phi, "right", 1)[0]
    assert force == pytest.approx(-4.0 * np.sign(made.cam.drive.motion.jet(phi)[1]), rel=1e-15)


def test_a_follower_without_friction_jams_at_transmission_angle_0() -> None:
    """A guide line that touches the base circle: the rise begins there."""
    made = design("plate_translating", "", ("offset = 12", "offset = 50"))
    (margin,) = friction(made).findings
    assert margin.severity == "broken"
    assert margin.value == pytest.approx(0.0, abs=1e-10)
    assert margin.cam_angle == pytest.approx(math.radians(30.0), abs=1e-12)


def test_no_friction_adds_nothing() -> None:
    made = design("groove", "")
    found = friction(made)
    phi = angles(made)
    for sense in (1, -1):
        assert np.all(found.per_normal(phi, "right", sense) == 0.0)
    assert np.all(found.force.coefficients(phi, "right") == 0.0)
    transmission = made.cam.disc.pitch_curve.transmission_angle(phi)
    assert statics(made).margin(phi, "right", 1) == pytest.approx(transmission, abs=1e-15)
    (column,) = found.columns
    assert column.values(phi, "right") == pytest.approx(np.degrees(transmission))


def test_a_rest_is_without_coulomb_s_friction_and_its_ends_have_two_sides() -> None:
    made = design("plate_translating", "")
    found = friction(made, guide=0.2)
    phi = np.radians([15.0, 150.0, 300.0])
    assert np.all(found.per_normal(phi, "right", 1)[0] == 0.0)
    start = np.radians([30.0])
    side = np.sin(made.cam.disc.pitch_curve.pressure_angle(start))
    assert found.per_normal(start, "left", 1)[0] == pytest.approx([0.0])
    assert found.per_normal(start, "right", 1)[0] == pytest.approx(-0.2 * side)
    end = np.radians([130.0, 130.0 + 360.0])
    side = np.sin(made.cam.disc.pitch_curve.pressure_angle(end))
    assert found.per_normal(end, "left", 1)[0] == pytest.approx(-0.2 * side)
    assert found.per_normal(end, "right", 1)[0] == pytest.approx([0.0, 0.0])


def test_in_a_rest_the_roller_still_costs_torque() -> None:
    """f |N| |Z'| / r_R and mu d/2 |N| (|Z'| / r_R - 1) with |Z'| = r_G, on the inner flank."""
    made = design("plate_translating", "")
    found = friction(made, **ROLLER)
    torque = found.per_normal(np.radians([15.0]), "right", 1)[1]
    wanted = 0.06 * 50.0 / 10.0 + 0.08 * 3.5 * (50.0 / 10.0 - 1.0)
    assert torque == pytest.approx(wanted, rel=1e-14)
    outer = found.per_normal(np.radians([15.0]), "right", -1)[1]
    assert outer == pytest.approx(0.06 * 5.0 + 0.08 * 3.5 * 6.0, rel=1e-14)


@pytest.mark.parametrize(
    ("scene", "key"), [("plate_translating", "guide_viscous"), ("groove", "pivot_viscous")]
)
def test_viscous_friction_of_the_follower(scene: str, key: str) -> None:
    made = design(scene, "")
    found = friction(made, **{key: 0.3})
    phi = angles(made)
    coefficients = found.force.coefficients(phi, "right")
    assert coefficients[1] == pytest.approx(-0.3 * made.cam.drive.motion.jet(phi)[1], rel=1e-15)
    assert np.all(coefficients[[0, 2, 3]] == 0.0)


def test_friction_of_a_slider_takes_its_power() -> None:
    """F |s'| and c s'^2 at the slider, k psi'^2 at the pivot, none in a rest."""
    made = design("setzhub", "")
    found = friction(made, slider=10.0, guide_viscous=0.02, pivot_viscous=30.0)
    phi = angles(made)
    swing, stroke = made.cam.drive.motion.jet(phi)[1], made.cam.drive.plan.jet(phi)[1]
    power = found.force.coefficients(phi, "right") * swing
    coulomb, viscous = -10.0 * np.abs(stroke), -0.02 * stroke**2 - 30.0 * swing**2
    assert power[0] == pytest.approx(coulomb, abs=1e-13 * 10.0 * float(np.max(np.abs(stroke))))
    assert power[1] == pytest.approx(viscous, abs=1e-13 * float(np.max(np.abs(viscous))))
    resting = np.radians([50.0])
    assert np.all(found.force.coefficients(resting, "right") == 0.0)


def test_the_values_are_smooth_between_the_borders() -> None:
    """Neighbours on a fine grid differ by little unless a border lies between them."""
    made = design("plate_translating", "")
    found = friction(made, **GUIDE, **ROLLER)
    edges = np.sort(np.concatenate((made.drive.smooth_angles, found.force.borders)))
    assert np.all((found.force.borders >= 0.0) & (found.force.borders < TURN))
    assert len(found.force.borders) > 0
    phi = np.linspace(0.0, TURN, 40_001)
    for sense in (1, -1):
        force = found.per_normal(phi, "right", sense)[0]
        bends = np.abs(np.diff(force, 2))
        near = np.searchsorted(edges, phi[2:] + 1e-9) != np.searchsorted(edges, phi[:-2] - 1e-9)
        # A second difference is the second derivative, of order 1, by the step squared, 2.5e-8; a
        # kink would be a slope, of order 0.1, by the step, 1.6e-5.
        assert np.max(bends[~near]) < 3e-7


@pytest.mark.parametrize(
    ("scene", "table", "key"),
    [
        ("groove", "guide = 0.1", "guide"),
        ("groove", "guide_length = 10.0", "guide_length"),
        ("groove", "guide_viscous = 0.1", "guide_viscous"),
        ("groove", "slider = 5.0", "slider"),
        ("plate_translating", "slider = 5.0", "slider"),
        ("plate_translating", "pivot = 0.1\npivot_diameter = 9.0", "pivot"),
        ("plate_translating", "pivot_viscous = 0.1", "pivot_viscous"),
        ("setzhub", "guide = 0.1", "guide"),
        ("knife_edge", "rolling = 0.01", "rolling"),
        ("knife_edge", "roller_pin = 0.1\nroller_pin_diameter = 5.0", "roller_pin"),
    ],
)
def test_parts_that_the_follower_does_not_have(scene: str, table: str, key: str) -> None:
    assert_refused(scene, "friction", table, key)


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"pivot": 0.1}, "pivot_diameter"),
        ({"roller_pin": 0.1}, "roller_pin_diameter"),
        ({"guide": 0.1, "guide_overhang": 5.0}, "guide_length"),
    ],
)
def test_coefficients_without_their_lengths(table: dict[str, float], key: str) -> None:
    with pytest.raises(GeometryError) as error:
        parse(table)
    assert error.value.key == key


def test_a_slider_that_cannot_be_moved() -> None:
    """The coupler comes across the guide within the stroke."""
    made = design("setzhub", "")
    plan = design("plate_translating", "").cam.drive.plan
    linkages = [SliderCrank(50.0, 60.0, 0.0, True, 1, -1, branch) for branch in (1, -1)]
    (locked,) = (each for each in linkages if locked_at(each, plan) is not None)

    drive = Changed(made.cam.drive, plan=plan, linkage=locked)
    with pytest.raises(EffectError, match="square to the guide"):
        friction(with_cam(made, drive=drive), slider=3.0)


def test_a_cusp_of_the_pitch_curve_has_no_answer() -> None:
    """The roller on the cam axis: it stands still in the turning cam, and there is no normal."""
    made = design("plate_translating", "")
    still: Any = Cusp()
    cusp = replace(made.cam.disc.pitch_curve, follower=still)
    disc = Changed(made.cam.disc, pitch_curve=cusp)
    with pytest.raises(EffectError, match="cusp"):
        friction(with_cam(made, disc=disc, follower=still), guide=0.1)


class Cusp:
    """A follower that stands still in the turning cam all along."""

    base_radius, roller_radius, reach, start_height = 50.0, 10.0, 1.0, 0.0
    ahead, offset, swing_sense = 0, 0.0, 0
    touching, rolls, has_edge, has_pitch_curve = "roller", True, False, True
    standstill = "the roller centre stands still: a cusp"

    def relative_jet(self, jet: FloatArray, *_: int) -> Any:
        still = np.zeros(jet.shape[1])
        return SimpleNamespace(u=still, v=still, turning=0.0)


class Changed:
    """An object with other attributes."""

    def __init__(self, of: Any, **changes: Any) -> None:
        self.__dict__.update(changes)
        self._of = of

    def __getattr__(self, name: str) -> Any:
        return getattr(self._of, name)


def with_cam(made: Design, **changes: Any) -> Any:
    """A design with other parts of its cam."""
    subject = made.effects.subject
    cam: Any = Changed(subject.cam, **changes)
    state = Demanded(cam.drive, cam, subject.course)
    return SimpleNamespace(
        effects=SimpleNamespace(subject=Changed(subject, cam=cam, drive=cam.drive, state=state))
    )


def test_from_a_scene() -> None:
    text = "".join(f"{key} = {value}\n" for key, value in {**GUIDE, **ROLLER}.items())
    made = design("plate_translating", f"[effects.friction]\n{text}")
    found = made.effect("friction")
    direct = friction(made, **GUIDE, **ROLLER)
    phi = angles(made)
    side: Side = "left"
    for sense in (1, -1):
        wanted = direct.per_normal(phi, side, sense)
        assert np.array_equal(found.per_normal(phi, side, sense), wanted)
    assert found.findings == direct.findings
    assert found.error is None
    assert [each.name for each in effect_findings(made)] == ["jamming-margin"]
