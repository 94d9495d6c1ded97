from __future__ import annotations

import math
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
from camgeo.errors import EffectError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import grid_of
from camgeo.units import TURN
from tests.effects.bodies import Bodies
from tests.effects.scenes import design
from tests.findings import finding

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
    at = Bodies(made.cam, phi, np.full(len(phi), float(sense)))
    slope = made.cam.drive.motion.jet(phi)[1]
    force, torque = found.per_normal(phi, "right", sense)
    given = (sense * made.cam.disc.pitch_curve.leverage(phi) + force) * slope
    taken = sense * made.cam.disc.pitch_curve.leverage(phi) * slope + torque
    spin = at.roller - at.turning
    assert (np.min(spin) * np.max(spin) < 0.0) == (changes == 2 and sense == 1)
    # Some hundred roundings of the powers and of what they are made of, the roller's rates.
    scale = np.max(np.abs(taken)) + np.max(np.abs(at.roller))
    assert np.max(np.abs(taken - given - at.losses(table, 0.0))) <= 1e-13 * scale
    assert np.max(np.abs(taken - at.torque(table))) <= 1e-13 * scale


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
    follower: Any = made.cam.follower
    found = made.effect("friction")
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


@pytest.mark.parametrize(
    ("share", "severity"), [(0.5, "ok"), (0.999, "warning"), (1.001, "broken")]
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
    margin = finding(friction(made, **table).findings, "jamming-margin")
    assert margin.severity == severity
    if share == 0.5:
        return
    assert margin.cam_angle == pytest.approx(float(phi[worst]), abs=math.radians(5.0))
    assert (margin.cam_range is None) == (severity == "warning")
    if margin.cam_range is not None:
        assert margin.value < 0.0 == margin.limit
        first, last = margin.cam_range
        assert first <= phi[worst] <= last
        jams = largest < coefficient
        assert np.all(jams[(phi > first + 1e-6) & (phi < last - 1e-6)])
        assert not np.any(jams[(phi < first - 1e-6) | (phi > last + 1e-6)])


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


def test_a_cusp_of_the_pitch_curve_has_no_answer() -> None:
    """The roller comes to rest on the cam axis: it stands still in the turning cam."""
    changes = (("offset = 12", "offset = 0"), ("to = 20", "to = -50"))
    with pytest.raises(EffectError, match="cusp"):
        friction(design("plate_translating", "", *changes), guide=0.1)
