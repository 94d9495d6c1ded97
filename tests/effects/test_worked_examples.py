"""Worked examples from the literature, see `fixtures/reference/dynamics_examples.toml`.

Each is made into a scene, with radii and parts that its source does not state and that do not
matter, and goes through all of camgeo. The tolerance is half a unit of the last digit printed.
"""

from __future__ import annotations

import math
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.scene.scene import load_scene, parse_scene
from tests.effects.scenes import course_of
from tests.findings import finding_of
from tests.reference import reference

INCH = 25.4
"""mm (international yard and pound agreement 1959)."""

POUND = 0.45359237
"""kg (as above)."""

POUND_FORCE = POUND * 9.80665
"""N (with the standard acceleration of free fall)."""

PSI = POUND_FORCE / INCH**2
"""MPa."""

ROUNDING = 1e-9
"""Share of half a unit that is left to the rounding of the test."""

SLOW = 60.0
"""rev/min, where the speed does not matter."""

PLATE = "base_radius = 100\nroller_radius = 15"
GROOVE = PLATE + '\ncontact = "groove"'
DISC = "[part]\nthickness = 20\nbore = 30\n"
BLANK = DISC + "rim = 480\ngroove_depth = 10\n"


def example(name: str) -> dict[str, Any]:
    found: dict[str, Any] = reference("dynamics_examples.toml")[name]
    return found


def number(case: dict[str, Any], key: str) -> float:
    return float(case[key])


def assert_printed(case: dict[str, Any], key: str, found: float) -> None:
    """Assert that `found` is printed as in the source, rounded or cut off."""
    digits = Decimal(case[key])
    exponent = digits.as_tuple().exponent
    assert isinstance(exponent, int)
    unit, expected = 10.0**exponent, float(digits)
    if key in case.get("cut", ()):
        sign = math.copysign(1.0, expected)
        assert 0.0 <= sign * (found - expected) < unit, key
    else:
        assert abs(found - expected) <= 0.5 * unit * (1.0 + ROUNDING), key


def scene(speed: float, follower: str, motion: str, effects: str, part: str = "") -> str:
    return f"""
camgeo = 1
name = "example"

[cam]
rotation = "ccw"
speed = {speed!r}

[follower]
kind = "translating-roller"
{follower}
{motion}
{part}
{effects}
"""


def made(*parts: Any) -> Design:
    return Design(parse_scene(scene(*parts), "example.toml"))


def move(law: str, span: float, to: float, more: str = "") -> str:
    return f'\n[[motion]]\nlaw = "{law}"\nspan = {span!r}\nto = {to!r}\n{more}'


def dwell(span: float) -> str:
    return f"\n[[motion]]\ndwell = {span!r}\n"


def column(design: Design, effect: str, name: str) -> Any:
    (one,) = (each for each in design.effect(effect).columns if each.name == name)
    return one.values


def at(function: Any, degrees: float, side: Side = "right") -> float:
    return float(function(np.array([math.radians(degrees)]), side)[0])


TABLED = np.linspace(0.0, 360.0, 3601)
"""Angles [degrees] of the rows of a table of loads."""

LOADED = '[effects.load]\nfile = "load.csv"\n'


def under_loads(folder: Path, loads: FloatArray, text: str) -> Design:
    """The scene with `LOADED` and a file of the loads at `TABLED`."""
    rows = zip(TABLED.tolist(), loads.tolist(), strict=True)
    (folder / "load.csv").write_text("".join(f"{a!r},{p!r}\n" for a, p in rows), "utf-8")
    (folder / "example.toml").write_text(text, "utf-8")
    return Design(load_scene(folder / "example.toml"))


# -- loads on a cam ------------------------------------------------------------------------------


def cam_loads(case: dict[str, Any]) -> Design:
    lift = INCH * number(case, "lift")
    first, second = number(case, "acceleration_span"), number(case, "deceleration_span")
    span = first + second
    law, rest = "quadratic-parabola", dwell(number(case, "dwell"))
    motion = (
        move(law, span, lift, f"inflection = {first / span!r}\n")
        + rest
        + move(law, span, 0.0, f"inflection = {second / span!r}\n")
        + rest
    )
    preload = POUND_FORCE * number(case, "spring_at_start")
    stiffness = (POUND_FORCE * number(case, "spring_at_top") - preload) / lift
    effects = f"""
[effects.kinematics]
[effects.inertia]
mass = {POUND * number(case, "weight")!r}
[effects.gravity]
[effects.load]
constant = {POUND_FORCE * number(case, "external_load")!r}
[effects.spring]
preload = {preload!r}
stiffness = {stiffness!r}
[effects.contact-force]
[effects.lift-off]
"""
    return made(number(case, "speed"), PLATE, motion, effects)


def test_accelerations_and_inertia_of_the_follower() -> None:
    case = example("cam_loads")
    design = cam_loads(case)
    course, inertia = course_of(design), design.effect("inertia").force

    def force(phi: FloatArray, side: Side) -> FloatArray:
        omega = course.rates(phi)[0]
        return np.asarray(-inertia.coefficients(phi, side)[2] * omega**2 / POUND_FORCE)

    for key, name in (("acceleration", "highest"), ("deceleration", "lowest")):
        found = finding_of(design, "kinematics", f"{name}-acceleration").value
        assert_printed(case, key, found / INCH)
    transition = number(case, "acceleration_span")
    lift = at(lambda phi, side: design.cam.drive.plan.jet(phi, side)[0], transition) / INCH
    assert lift == pytest.approx(number(case, "transition_lift"), rel=1e-12)
    assert_printed(case, "inertia", at(force, transition, "left"))
    assert_printed(case, "inertia_beyond", at(force, transition, "right"))


def test_loads_on_the_cam_along_the_guide() -> None:
    """The normal force times its leverage, on both sides of where the acceleration jumps."""
    case = example("cam_loads")
    design = cam_loads(case)
    contact, spring = design.effect("contact-force"), design.effect("spring").force

    def total(phi: FloatArray, side: Side) -> FloatArray:
        along = contact.normal(phi, side) * design.cam.disc.pitch_curve.leverage(phi, side)
        return np.asarray(along / POUND_FORCE)

    def pressing(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(-spring.coefficients(phi, side)[0] / POUND_FORCE)

    def combined(phi: FloatArray, side: Side) -> FloatArray:
        return total(phi, side) - pressing(phi, side)

    transition = number(case, "acceleration_span")
    top = transition + number(case, "deceleration_span")
    turn = 2.0 * (top + number(case, "dwell"))
    assert turn == 360.0
    assert_printed(case, "spring_at_transition", at(pressing, transition))
    assert_printed(case, "combined_beyond", at(combined, transition, "right"))
    assert_printed(case, "combined_dwell", at(combined, top, "right"))
    back = top + number(case, "dwell") + number(case, "deceleration_span")
    for key, angle, mirrored, before in (
        ("total_at_start", 0.0, turn - number(case, "dwell"), False),
        ("total_before_transition", transition, back, True),
        ("total_beyond_transition", transition, back, False),
        ("total_before_top", top, top + number(case, "dwell"), True),
    ):
        assert_printed(case, key, at(total, angle, "left" if before else "right"))
        assert_printed(case, key, at(total, mirrored, "right" if before else "left"))
    assert_printed(case, "total_at_top", at(total, top, "right"))
    assert_printed(case, "total_at_bottom", at(total, turn - 10.0))


def test_the_follower_is_lost_where_the_spring_was_designed() -> None:
    """With the preload that leaves nothing of the smallest load. Its place is the transition."""
    case = example("cam_loads")
    design = cam_loads(case)
    least, kept = (finding_of(design, "lift-off", name) for name in ("least-preload", "lift-off"))
    transition = math.radians(number(case, "acceleration_span"))
    back = 2.0 * math.pi - math.radians(number(case, "dwell")) - transition
    for found in (least, kept):
        assert min(abs(found.cam_angle - place) for place in (transition, back)) < 1e-6
    left = number(case, "spring_at_start") - least.value / POUND_FORCE
    assert_printed(case, "total_beyond_transition", left)


# -- motion --------------------------------------------------------------------------------------


def test_velocity_and_acceleration_of_a_valve() -> None:
    case = example("valve_motion")
    lift, rise, fall = (number(case, key) for key in ("lift", "rise", "fall"))
    rest = number(case, "dwell")
    roller = 0.5 * number(case, "roller_diameter")
    motion = (
        move("simple-sine", rise, lift)
        + dwell(rest)
        + move("simple-sine", fall, 0.0)
        + dwell(360.0 - rise - rest - fall)
    )
    radii = f"base_radius = {number(case, 'least_radius') + roller!r}\nroller_radius = {roller!r}"
    design = made(number(case, "speed"), radii, motion, "[effects.kinematics]")
    for key, name in (("rise", "highest"), ("fall", "lowest")):
        found = 1e-3 * finding_of(design, "kinematics", f"{name}-velocity").value
        assert_printed(case, f"{key}_velocity", abs(found))
    acceleration = column(design, "kinematics", "acceleration")
    for key, start, span in (("rise", 0.0, rise), ("fall", rise + rest, fall)):
        ends = piecewise_extremes(acceleration, np.radians([start, start + span]))
        assert_printed(case, f"{key}_acceleration", 1e-3 * ends.highest.value)
        assert_printed(case, f"{key}_acceleration", -1e-3 * ends.lowest.value)


# -- flywheels -----------------------------------------------------------------------------------


def test_flywheel_of_an_engine() -> None:
    """A groove cam with two strokes a turn under a constant force L takes L h sin 2 phi.

    What varies of the engine's torque is A sin(2 t - delta): the cam angle is t - delta / 2.
    """
    case = example("flywheel_of_an_engine")
    sine, cosine = number(case, "sine"), number(case, "cosine")
    lift = 100.0
    load = 1e3 * math.hypot(sine, cosine) / lift
    stroke = move("simple-sine", 90.0, lift) + move("simple-sine", 90.0, 0.0)
    fluctuation = number(case, "fluctuation")
    effects = f"""
[effects.load]
constant = {load!r}
[effects.drive-torque]
fluctuation = {fluctuation!r}
"""
    design = made(number(case, "speed"), GROOVE, stroke + stroke, effects, BLANK)
    assert_printed(case, "energy", finding_of(design, "drive-torque", "energy-fluctuation").value)
    moment = finding_of(design, "drive-torque", "flywheel").value
    exact = fluctuation * (math.pi * number(case, "speed") / 30.0) ** 2
    assert abs(exact - number(case, "divisor")) <= 0.005
    rounded = moment * exact / number(case, "divisor")
    assert_printed(case, "moment_of_inertia", rounded)
    delta = math.degrees(math.atan2(-cosine, sine))
    torque = design.effect("drive-torque").torque
    surplus = 1e-3 * at(torque, number(case, "angle") - 0.5 * delta)
    assert_printed(case, "angular_acceleration", surplus / rounded)


def engine_and_machine(case: dict[str, Any], folder: Path, effects: str) -> Design:
    """The surplus of the engine, sin t (2 A cos t + B), is what a cam gives back to the shaft.

    The lift h (1 - cos phi) / 2 gives back -L h sin(phi) / 2 under the force L. Between rows a
    tenth of a degree apart cos t loses 4e-7 of itself at most, (pi / 1800)^2 / 8; its slope is that
    of half a row away, which moves an extreme by a tenth of a row.
    """
    lift = 100.0
    first, second = number(case, "first_harmonic"), number(case, "second_harmonic")
    loads = -1e3 * (2.0 * second * np.cos(np.radians(TABLED)) + first) / (0.5 * lift)
    motion = move("simple-sine", 180.0, lift) + move("simple-sine", 180.0, 0.0)
    text = scene(number(case, "speed"), GROOVE, motion, LOADED + effects, BLANK)
    return under_loads(folder, loads, text)


def shaft_inertia(case: dict[str, Any]) -> float:
    """[kg m^2]"""
    return number(case, "mass") * number(case, "radius_of_gyration") ** 2


def test_shaft_between_an_engine_and_its_machine(tmp_path: Path) -> None:
    case = example("engine_and_machine")
    effects = "[effects.drive-torque]\nfluctuation = 0.01\n"
    design, inertia = engine_and_machine(case, tmp_path, effects), shaft_inertia(case)
    energy = finding_of(design, "drive-torque", "energy-fluctuation").value
    assert_printed(case, "energy", energy)
    flywheel = finding_of(design, "drive-torque", "flywheel").value
    assert_printed(case, "fluctuation", 100.0 * 0.01 * flywheel / inertia)
    torque = design.effect("drive-torque").torque
    ends = piecewise_extremes(torque, np.radians(np.linspace(0.0, 180.0, 1801)))
    for key, end in (("largest", ends.lowest), ("smallest", ends.highest)):
        assert_printed(case, f"{key}_acceleration", abs(1e-3 * end.value / inertia))
        assert_printed(case, f"{key}_at", math.degrees(end.place))


def test_speed_of_the_same_shaft_on_a_weak_motor(tmp_path: Path) -> None:
    """A motor without torque at the mean speed, with 4 % of 20 N m at the extreme ones: 8e-4 of the
    peak torque of 976 N m. The printed digits leave 8e-3.

    The source has the fluctuation from the energy, I w^2 C = I (w_max^2 - w_min^2) / 2 with the
    mean speed w. To it that is the middle of the extremes, which lies 1 % below the mean over time.
    """
    case = example("engine_and_machine")
    effects = f"""
[effects.speed-fluctuation]
moment_of_inertia = {shaft_inertia(case)!r}
no_load_speed = {number(case, "speed")!r}
stall_torque = 20
"""
    design = engine_and_machine(case, tmp_path, effects)
    high, low = (
        finding_of(design, "speed-fluctuation", f"{name}-speed").value
        for name in ("largest", "smallest")
    )
    fluctuation = 0.5 * (high - low) * (high + low) / number(case, "speed") ** 2
    assert_printed(case, "fluctuation", 100.0 * fluctuation)


# -- life of a bearing ---------------------------------------------------------------------------


def bearing_life(case: dict[str, Any], rating: float, load: float, more: str) -> Design:
    """The flank is as large as the roller, so the roller turns as fast as the cam. The load is
    constant except for the pressure angle of a lift of 1 micrometre, 1e-5 of the load on the flank.
    """
    motion = move("inclined-sine", 180.0, 0.001) + move("inclined-sine", 180.0, 0.0)
    effects = f"""
[effects.load]
constant = {load!r}
[effects.contact-pressure]
width = 50
rating = {rating!r}
{more}
"""
    radii = "base_radius = 200\nroller_radius = 100"
    return made(number(case, "speed"), radii, motion, effects)


def lives(design: Design) -> dict[str, float]:
    """In hours, and in millions of turns of the roller."""
    found = design.effect("contact-pressure").life
    turns = 1e-6 * found.seconds * found.speed / (2.0 * math.pi)
    return {"life": finding_of(design, "contact-pressure", "roller-life").value, "turns": turns}


def test_life_of_a_roller_bearing() -> None:
    """The required rating is known to half a unit: that much more is too much, that much less too
    little.
    """
    case = example("bearing_life")
    rating, load = 1e3 * number(case, "rating"), 1e3 * number(case, "load")
    half = 50.0  # N, of the last digit of the rating
    low, high = (lives(bearing_life(case, rating + off, load, "")) for off in (-half, half))
    for key in ("life", "turns"):
        assert low[key] < number(case, key) < high[key]


def test_life_of_a_ball_bearing() -> None:
    case = example("ball_bearing_life")
    rating, load = (POUND_FORCE * number(case, key) for key in ("rating", "load"))
    found = lives(bearing_life(case, rating, load, 'bearing = "ball"'))
    for key in ("life", "turns"):
        assert_printed(case, key, found[key])


# -- balance -------------------------------------------------------------------------------------


def test_permissible_unbalance() -> None:
    """Of a disc that is made as heavy by its density."""
    case = example("balance_grade")
    motion = move("modified-sine", 180.0, 5.0) + move("modified-sine", 180.0, 0.0)

    def disc(density: float) -> Design:
        effects = f"[effects.balance]\ngrade = {case['grade']}\ndensity = {density!r}\n"
        return made(number(case, "speed"), PLATE, motion, effects, DISC)

    mass = number(case, "mass")
    density = 1000.0 * mass / finding_of(disc(1000.0), "balance", "disc-mass").value
    design = disc(density)
    assert finding_of(design, "balance", "disc-mass").value == pytest.approx(mass, rel=1e-5)
    permissible = finding_of(design, "balance", "unbalance").limit
    assert_printed(case, "permissible", permissible)
    assert_printed(case, "per_mass", permissible / mass)


# -- vibration -----------------------------------------------------------------------------------


def test_no_vibration_remains_after_a_versed_sine_pulse() -> None:
    """Up and down in simple sines makes the pulse. Without damping the steady state has none only
    if each pulse leaves none. The natural frequencies are no harmonics of the cam's speed. What
    remains is known to the tolerance of the effect, as a share of the lift at least.
    """
    case = example("versed_sine_pulse")
    lift, span, speed = 20.0, 31.0, 60.0
    motion = (
        move("simple-sine", span, lift) + move("simple-sine", span, 0.0) + dwell(360 - 2 * span)
    )
    pulse = 2.0 * span / 360.0 * 60.0 / speed

    def left(ratio: float) -> float:
        table = f"[effects.vibration]\nnatural_frequency = {ratio / pulse!r}\ntolerance = 1e-9\n"
        design = made(speed, PLATE, motion, table)
        found: float = finding_of(design, "vibration", "largest-residual-vibration").value
        return found / lift

    lowest = number(case, "lowest_ratio")
    assert left(lowest) <= 1e-9
    lower = lowest * np.arange(0.1, 1.0, 0.1)
    assert all(left(ratio) > 1e-2 for ratio in (*lower.tolist(), lowest - 0.05))


# -- trains of many masses -----------------------------------------------------------------------


def chain_on_a_cam_at_rest(case: dict[str, Any], frequency: float, folder: Path) -> Design:
    """The first wall is the follower, which rests, the second one the frame. Between rows a tenth
    of a degree apart the cosine loses 4e-7 of itself at most, (pi / 1800)^2 / 8.
    """
    mass, stiffness, viscous = (number(case, key) for key in ("mass", "stiffness", "viscous"))
    spring = f"stiffness = {1e-3 * stiffness!r}, viscous = {1e-3 * viscous!r}"
    masses = [f"{{mass = {mass!r}, {spring}}}"] * 7
    held = spring.replace("stiffness", "ground_stiffness").replace("viscous", "ground_viscous")
    masses.append(f"{{mass = {mass!r}, {spring}, {held}}}")
    loads = -number(case, "force") * np.cos(np.radians(TABLED))
    tables = f"""
[effects.inertia]
mass = {8 * mass!r}
{LOADED}
[effects.vibration]
output = {case["loaded"]}
masses = [{", ".join(masses)}]
"""
    return under_loads(folder, loads, scene(60.0 * frequency, PLATE, dwell(360.0), tables, DISC))


@pytest.mark.parametrize("frequency", ["5_5", "40", "5", "6", "10"])
def test_a_chain_of_eight_masses_under_a_harmonic_force(frequency: str, tmp_path: Path) -> None:
    """The displacement of the loaded mass, a cos(w t) - b sin(w t) with a + i b as printed."""
    case = example("chain_of_eight")
    design = chain_on_a_cam_at_rest(case, float(frequency.replace("_", ".")), tmp_path)
    deflection = design.effect("vibration").output.deflection
    assert_printed(case, f"real_{frequency}", 1e-3 * at(deflection, 0.0))
    assert_printed(case, f"imaginary_{frequency}", -1e-3 * at(deflection, 90.0))


# -- helical springs -----------------------------------------------------------------------------


def helical(case: dict[str, Any], preload: float, largest: float, more: str = "") -> Design:
    """A spring that is `preload` to `largest` [lbf] on the way up and down again."""
    wire = {
        "diameter": INCH * number(case, "wire"),
        "coil_diameter": INCH * number(case, "coil"),
        "active_coils": number(case, "active"),
        "total_coils": number(case, "total"),
        "free_length": INCH * number(case, "free_length"),
        "shear_modulus": PSI * number(case, "shear_modulus"),
    }
    if "weight_density" in case:
        wire["density"] = POUND * number(case, "weight_density") / (1e-3 * INCH) ** 3
    keys = "\n".join(f"{key} = {value!r}" for key, value in wire.items())
    lift = INCH * (largest - preload) / number(case, "rate")
    motion = move("modified-sine", 180.0, lift) + move("modified-sine", 180.0, 0.0)
    table = (
        f"[effects.spring]\npreload = {POUND_FORCE * preload!r}\n[effects.spring.wire]\n{keys}\n"
    )
    return made(SLOW, PLATE, motion, table + more)


def test_stress_and_solid_length_of_a_helical_spring() -> None:
    case = example("spring_stress")
    design = helical(case, 4.0, number(case, "force"))
    spring = design.effect("spring")
    assert_printed(case, "rate", spring.stiffness / POUND_FORCE * INCH)
    force = finding_of(design, "spring", "largest-spring-force").value / POUND_FORCE
    stress = finding_of(design, "spring", "largest-spring-stress").value / PSI
    # The rate of rounded coils leaves a little of the force.
    assert_printed(case, "force", force)
    assert_printed(case, "stress", stress * number(case, "force") / force)
    assert_printed(case, "solid_length", spring.helical.solid_length / INCH)
    assert_printed(case, "solid_force", spring.helical.solid_force / POUND_FORCE)
    assert_printed(
        case, "solid_stress", finding_of(design, "spring", "solid-spring-stress").value / PSI
    )


def test_a_slender_helical_spring_with_its_surge() -> None:
    case = example("spring_that_buckles")
    forces = number(case, "smallest_force"), number(case, "largest_force")
    design = helical(case, *forces, "[effects.spring-surge]\n")
    frequency = finding_of(design, "spring-surge", "surge-frequency").value
    assert_printed(case, "frequency", frequency)
    assert_printed(case, "rate", design.effect("spring").stiffness / POUND_FORCE * INCH)
    assert_printed(case, "index", finding_of(design, "spring", "spring-index").value)
    assert_printed(case, "solid_length", design.effect("spring").helical.solid_length / INCH)
    assert_printed(case, "overrun", finding_of(design, "spring", "spring-closure").value)
    buckling = finding_of(design, "spring", "spring-buckling")
    assert buckling.severity == "warning"
    assert_printed(case, "stable_length", buckling.limit / INCH)
