"""Friction: the power that bearings, rolling and guides take, jamming, pivots and guides under
their whole loads, and rollers that roll or skid, as free bodies of their own.
"""

from __future__ import annotations

import itertools
import math
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.dynamics.effects.bearing_friction import (
    RubbingLaw,
    jam_reserve,
    scalar_linear_law,
    solve_balance,
)
from camgeo.dynamics.effects.effect import Request, Results
from camgeo.dynamics.effects.friction import Statics, compute, friction_statics
from camgeo.dynamics.effects.results import Friction
from camgeo.dynamics.effects.roller_spin import Rolling, Skid
from camgeo.dynamics.effects.tables import parse_friction as parse
from camgeo.errors import EffectError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import sample_grid
from camgeo.scene.scene import load_scene
from camgeo.units import RPM, TURN
from tests.effects.bodies import (
    DIFFERENCE,
    PLATE,
    ROLLER,
    Bodies,
    cross,
    friction,
    inside,
    omega,
    slope,
    speed_of,
)
from tests.effects.scenes import SCENES, design
from tests.findings import finding
from tests.long_form import LONG, examples

RUBBED_ROLLER: Final = {"roller_pin": 0.08, "roller_pin_diameter": 7.0, "rolling": 0.06}
GUIDE: Final = {"guide": 0.17, "guide_length": 45.0, "guide_overhang": 8.0}
PIVOT: Final = {"pivot": 0.13, "pivot_diameter": 24.0}

TURNED: Final = {"ccw": ('rotation = "ccw"', 'rotation = "cw"'),
                 "cw": ('rotation = "cw"', 'rotation = "ccw"')}  # fmt: skip

ROLLERS: Final = {
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


def friction_of(made: Any, **table: float) -> Friction:
    return compute(Request(made.effects.subject, parse(table), Results({}), 1e-6))


def statics(made: Any, **table: float) -> Statics:
    return friction_statics(made.effects.subject, parse(table))


def angles(made: Design) -> FloatArray:
    """Between the borders of the motion."""
    return sample_grid(made.drive.smooth_angles).ravel()


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("changes", [*range(3)])
@pytest.mark.parametrize("scene", ROLLERS)
def test_the_power_balance_closes(scene: str, changes: int, sense: int) -> None:
    """What the cam takes is what the follower gets, and what is lost in each of the bearings.

    As it is; turned the other way; and with a roller so large that on the inner flank it changes
    the sense in which it turns on its pin.
    """
    rotation, own = ROLLERS[scene]
    radius, large = LARGE[scene]
    change = [TURNED[rotation], (f"roller_radius = {radius}\n", f"roller_radius = {large}\n")]
    made = design(scene, "", *change[changes - 1 : changes] if changes else ())
    table = {**own, **RUBBED_ROLLER}
    found = friction_of(made, **table)
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
    found = friction_of(made, **table)
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
    angle = made.cam.disc.pitch_curve.pressure_angle(phi)
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
    margin = finding(friction_of(made, **table).findings, "jamming-margin")
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
    scene=st.sampled_from(sorted(ROLLERS)),
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
    found = friction_of(made, **table)
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
    for scene, (sense, _) in ROLLERS.items()
    for turned in (False, True)
}


def test_a_rest_is_without_coulomb_s_friction_and_its_ends_have_two_sides() -> None:
    made = design("plate_translating", "")
    found = friction_of(made, guide=0.2)
    assert np.all(found.per_normal(np.radians([15.0, 150.0, 300.0]), "right", 1)[0] == 0.0)
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
    found = friction_of(made, slider=10.0, guide_viscous=0.02, pivot_viscous=30.0)
    phi = angles(made)
    swing, stroke = made.cam.drive.motion.jet(phi)[1], made.cam.drive.plan.jet(phi)[1]
    power = found.force.coefficients(phi, "right") * swing
    coulomb, viscous = -10.0 * np.abs(stroke), -0.02 * stroke**2 - 30.0 * swing**2
    assert power[0] == pytest.approx(coulomb, abs=1e-13 * 10.0 * float(np.max(np.abs(stroke))))
    assert power[1] == pytest.approx(viscous, abs=1e-13 * float(np.max(np.abs(viscous))))
    assert np.all(found.force.coefficients(np.radians([50.0]), "right") == 0.0)


def test_the_values_are_smooth_between_the_borders() -> None:
    """Neighbours on a fine grid differ by little unless a border lies between them."""
    made = design("plate_translating", "")
    found = friction_of(made, **GUIDE, **RUBBED_ROLLER)
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
        friction_of(design("plate_translating", "", *changes), guide=0.1)


# Pivots and guides under their whole loads --------------------------------------------------------


ROUNDING: Final = 1e-12

NUMBERS: Final = st.floats(-1.0, 1.0)
VECTORS: Final = st.builds(complex, NUMBERS, NUMBERS)


def lever(**values: Any) -> Design:
    return Design(load_scene(SCENES.parent / "effects" / "lever.toml").with_values(values))


@given(
    st.floats(0.0, 1e3), st.floats(0.2, 1.0), st.floats(-0.9, 0.9),
    st.lists(st.tuples(VECTORS, VECTORS), min_size=1, max_size=2),
)  # fmt: skip
@example(1.0, 1.0, 2e-175, [(0j, 0j), (2.2e-315j, 0j), (0j, 2.2e-313j)])
@settings(max_examples=examples(40, long=2000))
def test_the_balance_has_one_root(
    released: float, free: float, share: float, loads: list[tuple[complex, complex]]
) -> None:
    """h(n) = |R_0|: the root is met to rounding, and a bracketing search finds it too."""
    own = np.array([[a] for a, _ in loads], dtype=np.complex128) * 100.0
    per = np.array([[b] for _, b in loads], dtype=np.complex128)
    size = float(np.sum(np.abs(per)))
    drag = share * free / max(size, 1e-3)
    demand = released - drag * float(np.sum(np.abs(own)))

    def left(n: float) -> float:
        return free * n - drag * float(np.sum(np.abs(own + per * n))) - demand

    one = np.ones(1)
    assert jam_reserve(free * one, drag * one, per)[0] > 0.0
    (n,), _ = solve_balance(demand * one, free * one, drag * one, own, per)
    terms = abs(demand) + abs(drag) * float(np.sum(np.abs(own) + np.abs(per) * n)) + free * n
    assert n >= -ROUNDING * terms / free
    assert abs(left(n)) <= ROUNDING * terms
    if released > 1e-3:
        wanted = brentq(left, 0.0, 1e7, xtol=1e-13, rtol=1e-14)
        assert n == pytest.approx(wanted, rel=1e-9, abs=1e-9)


@given(st.floats(1.0, 200.0), st.floats(-500.0, 500.0), st.floats(1e-4, 1.0), st.integers(0, 10))
@settings(max_examples=examples(20, long=1000))
def test_one_cam_angle_gives_what_many_do(
    omega: float, alpha: float, slowing: float, seed: int
) -> None:
    """The law for single numbers, and the linear law has the torque and the slope of the whole."""
    numbers = np.random.default_rng(seed)
    parts = [numbers.normal(size=(8, each)) for each in (1, 2)]
    own = (parts[0] @ np.ones((1, 2))).reshape(4, 2, 2)[:, :1] + 1j * numbers.normal(size=(4, 1, 2))
    law = RubbingLaw(
        demand=numbers.normal(size=(4, 2)) * 50.0,
        torque=np.array([[3.0, 2.0], [-3.0, -2.0]]),
        free=np.array([[5.0, 6.0], [-5.0, -6.0]]),
        drag=np.array([0.3, -0.3]),
        noncontact_loads=own,
        per_normal=np.exp(1j * numbers.normal(size=(2, 1, 2))),
    )
    law = RubbingLaw.from_rows(law.rows)
    linear = law.linear(omega, alpha)
    for k in range(2):
        one = scalar_linear_law(law.rows[:, k].tolist(), omega, alpha, 0.0)
        assert one == pytest.approx(linear[:, k].tolist(), rel=1e-9, abs=1e-9)

    def torque(omega: float, alpha: float) -> FloatArray:
        index, n, _ = law.solved(omega, alpha)
        return np.asarray(np.where(index == 0, law.torque[0], law.torque[1]) * n)

    c0, c1, c2, c3, gain, _ = linear
    force = c0 + omega * (c1 + omega * c2) + alpha * c3
    assert np.allclose(gain * force, torque(omega, alpha), rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("mu", [0.1, 0.4])
def test_at_lift_off_with_a_loaded_pivot_the_force_is_0(mu: float) -> None:
    """At the lift-off speed, and at a higher speed with the least preload and stiffness."""
    less = {"effects.vibration": None, "effects.contact-pressure": None,
            "effects.drive-torque": None, "effects.friction.pivot": mu}  # fmt: skip

    def told(**values: Any) -> dict[str, Any]:
        return {
            each.name: each.value for each in lever(**less, **values).effect("lift-off").findings
        }

    speed = told()["lift-off-speed"]
    fast = told(**{"cam.speed": 1300.0})
    changes: list[dict[str, Any]] = [{"cam.speed": speed}]
    changes += [
        {"cam.speed": 1300.0, f"effects.spring.{key}": fast[f"least-{key}"]}
        for key in ("preload", "stiffness")
    ]
    for change in changes:
        extremes = lever(**less, **change).effect("contact-force").extremes
        assert abs(extremes.lowest.value) <= 1e-9 * extremes.magnitude


def linked_press(**values: Any) -> Design:
    """Rigid, at the stated speed, with a pivot that takes much."""
    less = dict.fromkeys(("speed-fluctuation", "contact-pressure", "vibration", "balance"))
    changes = {f"effects.{name}": None for name in less} | {"effects.friction.pivot": 0.4}
    scene = load_scene(SCENES.parent / "effects" / "linked_press.toml")
    return Design(scene.with_values({**changes, **values}))


def test_at_lift_off_behind_a_linkage_the_force_is_0() -> None:
    """The spring presses on the slider, and loads the pivot through the coupler."""
    told = {each.name: each.value for each in linked_press().effects.findings("lift-off")}
    fast = {"cam.speed": 500.0}
    changes = [{"cam.speed": told["lift-off-speed"]}]
    if LONG:  # the least preload of a loaded pivot without a linkage is below
        over = {each.name: each.value for each in linked_press(**fast).effects.findings("lift-off")}
        assert (over["least-preload"] or 0.0) > 480.0
        changes.append({**fast, "effects.spring.preload": over["least-preload"]})
    for change in changes:
        extremes = linked_press(**change).effect("contact-force").extremes
        assert abs(extremes.lowest.value) <= 1e-9 * extremes.magnitude


# Roller spin --------------------------------------------------------------------------------------


INERTIA: Final = 3e-2
"""[t mm^2]"""


def rolling(scene: str, rev: float, traction: float = 0.05, *changes: tuple[str, str]) -> Design:
    table = f"\n[effects.roller-spin]\nmoment_of_inertia = {1e-3 * INERTIA!r}\n"
    forces = "[effects.load]\nconstant = 40\n[effects.inertia]\nmoment_of_inertia = 0.01\n"
    forces = PLATE if scene == "plate_translating" else forces
    text = f"{forces}{friction(ROLLER)}{table}traction = {traction!r}"
    return design(scene, text, speed_of(scene, rev), *changes)


def groove(inertia: float, traction: float = 0.06) -> Design:
    path = SCENES.parent / "effects" / "groove_lever.toml"
    table = {"moment_of_inertia": inertia, "traction": traction}
    return Design(load_scene(path).with_values({"effects.roller-spin": table}))


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle"])
def test_it_rolls_on_its_flank(scene: str) -> None:
    """No slip at the contact, by velocities in the fixed frame."""
    made = rolling(scene, 90.0)
    phi = inside(made)
    bodies = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    wanted = (bodies.roller, bodies.roller - bodies.turning)
    found = made.effect("roller-spin").rolling.spin(phi, "right")
    for own, other in zip(found, wanted, strict=False):
        assert np.max(np.abs(own / omega(made) - other)) <= DIFFERENCE * np.max(np.abs(other))
    (column,) = (each for each in made.effect("roller-spin").columns if each.name == "roller spin")
    assert column.values(phi, "right") == pytest.approx(found[1] / RPM)


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_its_angular_momentum_changes_by_friction_and_traction(way: str) -> None:
    """The force of the cam acts at the contact, along the tangent there."""
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    made = rolling("plate_translating", 200.0, 0.05, *turned)
    phi, roller = inside(made), made.effect("roller-spin").rolling
    at = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    ahead = -made.cam.rotation * 1j * at.outward  # as the contact moves along the flank
    moment = cross(at.arm, roller.traction(phi, "right") * ahead) + sum(at.moments(ROLLER))
    gain = omega(made) * slope(lambda x: roller.spin(x, "right")[0], phi)
    assert np.max(np.abs(INERTIA * gain - moment)) <= 1e3 * DIFFERENCE * np.max(np.abs(moment))


def test_it_skids_where_the_traction_does_not_suffice() -> None:
    loose = rolling("plate_translating", 200.0, 1.0)
    roller, contact = loose.effect("roller-spin").rolling, loose.effect("contact-force")
    phi = np.linspace(0.0, contact.edges[-1], 20001)
    share = np.abs(roller.traction(phi, "right") / contact.normal(phi, "right"))
    needed = float(np.max(share))

    def told(traction: float) -> Any:
        found = rolling("plate_translating", 200.0, traction).effect("roller-spin").findings
        return next(each for each in found if each.name == "traction-reserve")

    assert told(1.01 * needed).severity == "ok"
    assert told(1.01 * needed).value > 0.0
    skids = told(0.99 * needed)
    assert skids.severity == "warning"
    assert "too little" in skids.sentence
    assert skids.value < 0.0


def test_in_a_groove_it_reverses_at_each_change_of_flanks() -> None:
    made = groove(4e-9)
    found = {each.name: each for each in made.effect("roller-spin").findings}
    changes = [each for each in made.effects.findings("lift-off") if each.name == "flank-change"]
    assert found["roller-reversal"].value == len(changes) == 4
    assert found["roller-reversal"].cam_angle == pytest.approx(changes[0].cam_angle)
    assert found["largest-roller-spin"].value > 0.0 > found["smallest-roller-spin"].value


# Skidding -----------------------------------------------------------------------------------------
# How far a roller skids, against its equation of motion solved by others' means.


SOLVED: Final = 1e-9
"""Of solvers whose steps are good to 1e-12: some hundreds of them, and their events."""

FINDINGS: Final = ("largest-slip", "slip-distance", "slip-work")


def skid_of(made: Design) -> Skid:
    found = made.effect("roller-spin").skid
    assert isinstance(found, Skid)
    return found


def values(made: Design) -> dict[str, float]:
    return {each.name: each.value for each in made.effect("roller-spin").findings}


def turned(skid: Skid, phi: FloatArray, side: Any) -> FloatArray:
    """w [rad/s]."""
    return np.asarray(skid.spin(phi, side)[0] + skid.cells.rolling.rubbed(phi, side)[0][0])


# Against a solver ---------------------------------------------------------------------------------


class Solved:
    """A roller that rolls at cam angle 0, over a turn: w, path and work of its slip."""

    def __init__(self, made: Design, friction: dict[str, float], traction: float) -> None:
        self.rolling: Rolling = made.effect("roller-spin").rolling
        self.radius = made.cam.follower.roller_radius
        self.flank = traction * self.radius
        self.pin = 0.5 * friction.get("roller_pin", 0.0) * friction.get("roller_pin_diameter", 0.0)
        self.of_rolling = friction.get("rolling", 0.0)
        self.slips: list[tuple[float, float]] = []
        self.distance = self.work = 0.0
        held, w = True, 0.0
        for low, high in itertools.pairwise(self.rolling.contact.edges.tolist()):
            held, w = self.over(low, high, w, held=held and self.follows(low))
        assert held

    def at(self, phi: float, w: float | None = None) -> tuple[float, ...]:
        """omega_R, its rate, |N| and omega, and the moment of friction per |N|, at w or rolling."""
        here = np.array([phi])
        v, rates = (each[:, 0] for each in self.rolling.rubbed(here, "right"))
        size = abs(float(self.rolling.contact.normal(here, "right")[0]))
        w = v[0] if w is None else w
        rest = -self.pin * np.sign(w - v[1]) - self.of_rolling * np.sign(w - v[2])
        return v[0], rates[0], size, self.rolling.course.rates(here)[0, 0], rest

    def follows(self, phi: float) -> bool:
        """Whether omega_R does not jump."""
        here = np.array([phi])
        before, after = (self.rolling.rubbed(here, side)[0][0, 0] for side in ("left", "right"))
        return bool(abs(after - before) <= 1e-9 * abs(before))

    def lacking(self, phi: float) -> float:
        """The moment that the flank lacks [N mm]."""
        _, rate, size, _, rest = self.at(phi)
        inertia = self.rolling.data.moment_of_inertia
        return abs(inertia * rate - size * rest) - self.flank * size

    def over(self, low: float, high: float, w: float, *, held: bool) -> tuple[bool, float]:
        """The cell from `low` to `high`, free of its ends by rounding."""
        inset = 1e-12 * (high - low)
        low, high = low + inset, high - inset
        while low < high:
            if held:
                grid = np.linspace(low, high, 64)
                lacks = np.array([self.lacking(each) for each in grid])
                out = np.flatnonzero(lacks > 0.0)
                if not len(out):
                    return True, self.at(high)[0]
                if out[0] > 0:
                    low = brentq(self.lacking, grid[out[0] - 1], grid[out[0]], xtol=1e-15)
                w, rate, size, _, rest = self.at(low)
                sense = np.sign(size * rest - self.rolling.data.moment_of_inertia * rate)
            else:
                sense = np.sign(w - self.at(low)[0])
            start = low
            low, w = self.slip(low, high, w, float(sense))
            self.slips.append((start, low))
            held = low < high and self.lacking(low) <= 0.0
        return held, w

    def slip(self, low: float, high: float, w: float, sense: float) -> tuple[float, float]:
        def rate(phi: float, y: FloatArray) -> list[float]:
            rolls, _, size, omega, rest = self.at(phi, float(y[0]))
            pull = size * (rest - sense * self.flank) / self.rolling.data.moment_of_inertia
            path = self.radius * abs(y[0] - rolls)
            return [pull / omega, path / omega, self.flank / self.radius * size * path / omega]

        def gap(phi: float, y: FloatArray) -> float:
            return float(sense * (y[0] - self.at(phi)[0])) if phi > low else 1.0

        gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]  # scipy's way
        done = solve_ivp(
            rate, (low, high), [w, self.distance, self.work],
            method="DOP853", rtol=1e-12, atol=1e-12, events=gap,
        )  # fmt: skip
        w, self.distance, self.work = done.y[:, -1]
        return float(done.t[-1]), float(w)


def assert_solved(made: Design, friction: dict[str, float], traction: float) -> None:
    skid, solved = skid_of(made), Solved(made, friction, traction)
    found = values(made)
    assert found["slip-distance"] == pytest.approx(solved.distance, rel=SOLVED)
    assert found["slip-work"] == pytest.approx(1e-3 * solved.work, rel=SOLVED)
    (start, end), *_ = skid.ranges
    assert start == pytest.approx(solved.slips[0][0], abs=SOLVED)
    assert any(abs(end - each[1]) <= SOLVED for each in solved.slips)


def test_a_plate_cam_that_spins_its_roller_too_fast() -> None:
    assert_solved(rolling("plate_translating", 200.0, 0.02), ROLLER, 0.02)


def test_a_groove_that_reverses_its_roller() -> None:
    assert_solved(groove(4e-8), {}, 0.06)


# Against steps of its own, whatever holds it ------------------------------------------------------


def stepped(skid: Skid, count: int) -> tuple[FloatArray, FloatArray, float]:
    """Angles, w there, and the largest step, by Euler's implicit method from the same start.

    The moments fall as w rises, so each step has one answer: the sum over the sorted v_i.
    """
    roller = skid.cells.rolling
    phi = np.union1d(np.linspace(0.0, TURN, count), roller.contact.edges)
    middle = 0.5 * (phi[1:] + phi[:-1])
    v, levers = roller.rubbed(phi[1:], "left")[0].T, roller.levers
    pressing = roller.pressing(middle, "right") / roller.course.rates(middle)[0]
    pulls = pressing * np.diff(phi) / roller.data.moment_of_inertia
    w = [float(turned(skid, phi[:1], "right")[0])]
    for pull, row in zip(pulls.tolist(), v.tolist(), strict=True):
        best = w[-1] + pull * float(np.sum(levers))
        for lever, each in sorted(zip(levers.tolist(), row, strict=False), key=lambda x: x[1]):
            if best <= each:
                break
            best = max(best - 2.0 * pull * lever, each)
            if best == each:
                break
        w.append(best)
    rise = np.abs(np.diff(roller.rubbed(phi, "right")[0][:, :-1], axis=1))
    smooth = np.quantile(rise, 0.99)  # the others are the jumps where flanks change
    return phi, np.array(w), float(smooth + np.max(pulls) * np.sum(levers))


EVENTS: Final = 24
"""More than changes of what holds the roller in a turn; each is found late by up to a step."""


def drawn(scene: str, inertia: float, traction: float, rev: float) -> Design:
    if scene == "groove_lever":
        return groove(inertia, traction)
    made = rolling(scene, rev, traction)
    table = {"moment_of_inertia": inertia, "traction": traction}
    return Design(made.scene.with_values({"effects.roller-spin": table}))


@settings(max_examples=examples(6, long=100), deadline=None)
@given(
    st.sampled_from(["groove_lever", "plate_translating", "shuttle"]),
    st.floats(-7.0, -1.0),
    st.floats(-4.0, -0.7),
    st.floats(60.0, 900.0),
)
def test_whatever_holds_it_it_moves_as_in_small_steps(
    name: str, inertia: float, traction: float, rev: float
) -> None:
    made = drawn(name, 10.0**inertia, 10.0**traction, rev)
    skid = made.effect("roller-spin").skid
    if skid is None:
        assert [values(made)[each] for each in FINDINGS] == [0.0, 0.0, 0.0]
        return
    phi, w, step = stepped(skid, examples(2001, long=20001))
    assert np.max(np.abs(turned(skid, phi[1:], "left") - w[1:])) <= EVENTS * step
    # the end of the turn is its start, and what nobody jumps over is continuous
    after, before = (turned(skid, skid.edges[:-1], side) for side in ("right", "left"))
    assert np.max(np.abs(after - before)) <= 1e-12 * skid.cells.fastest


# Balances -----------------------------------------------------------------------------------------


def test_a_roller_that_its_pin_holds_slips_all_round_the_cam() -> None:
    """By the length of the outline, that of the pitch curve less the roller's circumference."""
    made = rolling("plate_translating", 60.0, 1e-4)
    found = values(made)
    points = made.cam.disc.pitch_curve.point(np.linspace(0.0, TURN, 20001))
    outline = float(np.sum(np.abs(np.diff(points)))) - TURN * made.cam.follower.roller_radius
    assert found["largest-roller-spin"] == found["smallest-roller-spin"] == 0.0
    assert found["slip-distance"] == pytest.approx(outline, rel=1e-7)
    share = 0.5 * ROLLER["roller_pin"] * ROLLER["roller_pin_diameter"] + ROLLER["rolling"]
    assert found["roller-drag"] == pytest.approx(share / made.cam.follower.roller_radius)


def test_without_inertia_it_does_not_slip() -> None:
    """|N| rises from 0 where the flanks change, so the slip goes with the root of the inertia."""
    coarse, fine = (values(groove(each))["slip-distance"] for each in (1e-12, 1e-14))
    assert coarse / fine == pytest.approx(10.0, rel=1e-3)
    assert [values(groove(0.0))[each] for each in FINDINGS] == [0.0, 0.0, 0.0]


def test_where_nothing_presses_it_keeps_its_spin() -> None:
    made = rolling("plate_translating", 900.0)
    skid = skid_of(made)
    for lost in made.effect("contact-force").lost_contact.ranges:
        w = turned(skid, np.linspace(lost.start, lost.end, 21), "right")
        assert np.ptp(w) <= 1e-12 * skid.cells.fastest
    assert {each.severity for each in made.effects.findings("roller-spin")} == {"broken", "warning"}


def test_what_nothing_turns_has_no_slip_that_is_known() -> None:
    made = groove(1e-6, 0.0)
    found = {each.name for each in made.effect("roller-spin").findings}
    assert "roller-undriven" in found
    assert not found & set(FINDINGS)


def test_a_roller_that_rolls_is_not_followed() -> None:
    made = rolling("plate_translating", 60.0, 0.2)
    found = {each.name: each for each in made.effect("roller-spin").findings}
    assert made.effect("roller-spin").skid is None
    assert [found[each].value for each in FINDINGS] == [0.0, 0.0, 0.0]
    columns = {each.name: each for each in made.effect("roller-spin").columns}
    assert not np.any(columns["roller slip"].values(np.linspace(0.0, math.pi, 5), "right"))
