"""Hard cases of the effects together: the right value or a clear finding, never anything else.

Every scene here also passes `assert_well_formed`: findings, columns on both sides of all their
borders, and JSON are finite, and Python raises no warning.
"""

from __future__ import annotations

import math
import re
from typing import Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.registry import ROLLERS
from camgeo.errors import EffectError
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.effects.scenes import SCENES, changed, course_of, only_for
from tests.effects.test_random_scenes import NAMES, assert_well_formed, scene_text
from tests.findings import finding_of, names_of
from tests.long_form import LONG, examples

ROUNDING: Final = 1e-12
"""A few thousand roundings of the largest force, as in the tests of the contact force."""

EVERY: Final = """
[effects.kinematics]
[effects.inertia]
{inertia}
[effects.gravity]
[effects.load]
constant = {load}
[effects.spring]
{spring}
[effects.friction]
roller_pin = 0.01
roller_pin_diameter = {pin}
rolling = {rolling}
{friction}
[effects.contact-force]
[effects.lift-off]
[effects.drive-torque]
fluctuation = 0.05
[effects.speed-fluctuation]
moment_of_inertia = 0.3
no_load_speed = 100
stall_torque = {stall}
[effects.contact-pressure]
width = {width}
rating = 9000
[effects.vibration]
{vibration}
[effects.shock-spectrum]
highest_ratio = {ratio}
[effects.balance]
"""

COMMON: Final = {
    "pin": "5", "rolling": "0.01", "width": "0.1", "stall": "400",
    "ratio": examples("2.5", long="10"),
}  # fmt: skip
"""The spectrum up to 10, the default, is half of what all effects take; `test_shock_spectrum` has
its values, and the long form has it of every scene here."""

GUIDE: Final = {
    "inertia": "mass = 1\nroller_mass = 0.1",
    "load": "10",
    "spring": "stiffness = 3\npreload = 300",
    "friction": "guide = 0.05\nguide_viscous = 0.01",
    "vibration": "stiffness = 900\ndamping = 0.03",
}
ROCKER: Final = {
    "inertia": "moment_of_inertia = 0.01\nroller_mass = 0.1\nrocker_mass = 0.5",
    "load": "1",
    "spring": 'kind = "torsion"\ntorsional_stiffness = 30\npreload_torque = 40',
    "friction": "pivot = 0.05\npivot_diameter = 15\npivot_viscous = 0.01",
    "vibration": "torsional_stiffness = 9000\ndamping = 0.03",
}
LINKAGE: Final = {
    "inertia": "mass = 1\nmoment_of_inertia = 0.01\nroller_mass = 0.1\ncoupler_mass = 0.2",
    "load": "10",
    "spring": "stiffness = 3\npreload = 300",
    "friction": "pivot = 0.05\npivot_diameter = 15\nslider = 3\nguide_viscous = 0.01",
    "vibration": "stiffness = 900\ndamping = 0.03",
}
TURNING: Final = {"inertia": "\ncoupler_mass = 0.2\noutput_moment = 0.005"}
"""Further tables for a linkage with a rotating far end."""

HARMONIC: Final = """
camgeo = 1
name = "eccentric"

[cam]
rotation = "ccw"
speed = 60

[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10

[[motion]]
law = "simple-sine"
span = 180
to = 20

[[motion]]
law = "simple-sine"
span = 180
to = 0
"""
"""s = 10 mm (1 - cos phi): one harmonic. Turning once a second, omega is 2 pi."""


def made(text: str, effects: str = "") -> Design:
    """The scene with `effects`; unless it states otherwise, or in the long form, with a rigid
    train: a motor before an elastic one takes most of the time, and is in `test_found_speed` and
    `test_recorded`.
    """
    if not (LONG or "[state]" in text or "[state]" in effects):
        effects += '\n[state]\noutput = "rigid"\n'
    return Design(parse_scene(f"{text}\n{effects}", str(SCENES / "scene.toml")))


def with_speed(name: str, rev: str = "90") -> str:
    """The fixture scene; at `rev` rev/min if it has no speed of its own."""
    text = scene_text(name)
    if "\nspeed" in text:  # or a table of it
        return text
    return text.replace("[follower]\n", f"speed = {rev}\n[follower]\n", 1)


AT_STATED_SPEED: Final = '\n[state]\nspeed = "stated"\n'
"""That [cam] says how the cam turns, though a motor is given."""


def every(text: str, **data: str) -> str:
    """Tables of all effects that suit the follower of `text`."""
    rocks = "oscillating" in text
    turns = "[linkage]" in text and ("four-bar" in text or not rocks)
    own = ROCKER if rocks else GUIDE
    if turns:
        own = {
            **own,
            "inertia": own["inertia"] + TURNING["inertia"],
            "load": ROCKER["load"],
            "vibration": ROCKER["vibration"],
        }
    elif "[linkage]" in text:
        own = LINKAGE
    tables = EVERY.format(**{**COMMON, **own, **data})
    if "\nroller_radius = 0\n" in text:  # a knife edge has no friction of a roller
        tables = re.sub(r"^roll(er_pin|er_pin_diameter|ing) = .*\n", "", tables, flags=re.MULTILINE)
    if '-flat"' in text:
        for _, key in only_for(ROLLERS):
            tables = re.sub(rf"^{key} = .*\n", "", tables, flags=re.MULTILINE)
        of_face = "face = 0.08\n" if rocks else "face = 0.08\nguide_length = 40\n"
        tables = tables.replace("[effects.friction]\n", f"[effects.friction]\n{of_face}")
    if "[follower.return]" in text:  # two discs have no balance of one
        tables = tables.replace("[effects.balance]\n", "")
    return tables


NOT_ANSWERED: Final[dict[str, dict[str, str]]] = {
    "straight_moves": {
        "speed-fluctuation": "shock",
        "contact-pressure": "infinite-contact-pressure",
    },
    "swallow_tail": {"contact-pressure": "infinite-contact-pressure"},
    "trimmed_ring": {"contact-pressure": "infinite-contact-pressure"},
    "cut_lobe": {"contact-pressure": "infinite-contact-pressure"},
    "knife_edge": {
        "contact-pressure": "key follower.roller_radius",
        "speed-fluctuation": "shock",
    },
}
"""A jump of the speed; a corner of the flank under force; a knife edge."""


SWEPT: Final = NAMES if LONG else sorted({*NOT_ANSWERED, *NAMES[1::3]})
"""Each kind of follower and of motion is among them."""


@pytest.mark.parametrize("name", SWEPT)
def test_every_effect_of_every_scene(name: str) -> None:
    """Measured lifts, a speed curve, inches, shocks, cusps, undercut: each as it may be."""
    text = with_speed(name)
    assert assert_well_formed(made(text, every(text))) == NOT_ANSWERED.get(name, {})


REST: Final = "[[motion]]\ndwell = 360\n"


@pytest.mark.parametrize("name", ["plate_translating", "shuttle", "groove", "setzhub"])
def test_a_cam_that_never_moves_its_follower(name: str) -> None:
    text = scene_text(name)
    head, tail = text[: text.index("[[motion]]")], text[text.index("[part]") :]
    design = made(head + REST + tail, every(text))
    assert assert_well_formed(design) == {}
    assert names_of(design, "shock-spectrum") == {"shock-spectrum"}
    phi = np.linspace(0.0, TURN, 50)
    normal = design.effect("contact-force").normal(phi, "right")
    assert np.ptp(normal) <= ROUNDING * np.max(np.abs(normal))
    # The roller turns on its pin and rolls: they alone take torque.
    smooth = made(head + REST + tail, re.sub(r"\[effects.friction\][^[]*", "", every(text)))
    assert not np.any(smooth.effect("drive-torque").torque(phi, "right"))
    assert np.all(design.effect("drive-torque").torque(phi, "right") > 0.0)
    # The load is constant, too: it deflects its train, and nothing vibrates.
    bent = design.effect("vibration").output.deflection(phi, "right")
    assert np.ptp(bent) <= ROUNDING * np.max(np.abs(bent))
    assert np.all(bent < 0.0)


def test_a_rest_of_no_length_changes_nothing() -> None:
    text = changed(scene_text("plate_translating"), ("dwell = 70", "dwell = 110"))
    none = changed(text, ("[[motion]]\ndwell = 40\n", ""))
    zero = changed(text, ("dwell = 40", "dwell = 0"))
    one, other = made(none, every(text)), made(zero, every(text))
    assert assert_well_formed(other) == {}
    phi = np.linspace(0.0, TURN, 500, endpoint=False)
    for here, there in zip(one.disc.columns(), other.disc.columns(), strict=True):
        assert np.array_equal(here.values(phi, "right"), there.values(phi, "right")), here.name


@pytest.mark.parametrize("ratio", [1, 3, 17])
def test_resonance_without_damping(ratio: int) -> None:
    """A motion of many harmonics resonates with each: that effect says so, and all that are for the
    train. Others answer, and `speed-fluctuation` too: where the speed of the scene holds, it takes
    the train as rigid.
    """
    text = scene_text("plate_translating")
    effects = every(text, vibration=f"natural_frequency = {ratio}")
    design = made(text, effects + AT_STATED_SPEED)
    forces = {"contact-force", "lift-off", "drive-torque", "contact-pressure"}
    assert assert_well_formed(design) == dict.fromkeys({"vibration", *forces}, "resonance")
    rigid = made(text, f'{effects}{AT_STATED_SPEED}output = "rigid"\n')
    assert assert_well_formed(rigid) == {"vibration": "resonance"}
    each = finding_of(design, "vibration", "resonance")
    assert (each.severity, each.value) == ("broken", pytest.approx(float(ratio), rel=1e-12))


@pytest.mark.parametrize("ratio", [2, 3, 5])
def test_no_resonance_with_a_harmonic_that_the_motion_does_not_have(ratio: int) -> None:
    """s = h/2 (1 - cos phi) has one harmonic: its deflection is h/2 / (ratio^2 - 1) at most.

    x'' + w^2 x = w^2 s has the steady state h/2 (1 - cos phi / (1 - 1 / ratio^2)) (any textbook of
    vibrations, forced motion by a base that moves).
    """
    design = made(HARMONIC, f"[effects.vibration]\nnatural_frequency = {ratio}\n")
    assert assert_well_formed(design) == {}
    most = finding_of(design, "vibration", "largest-motion-error").value
    # The law is known to 1e-16, and the steady state to the tolerance of 1e-6 of the lift.
    assert most == pytest.approx(10.0 / (ratio**2 - 1.0), rel=1e-6)
    resonance = finding_of(design, "vibration", "resonance")
    assert resonance.value is None
    assert "absent from the motion" in resonance.sentence
    only = made(HARMONIC, "[effects.vibration]\nnatural_frequency = 1\n")
    assert finding_of(only, "vibration", "resonance").severity == "broken"


def test_without_mass_nothing_vibrates_or_lifts_off() -> None:
    text = scene_text("plate_translating")
    design = made(text, every(text, inertia="mass = 0") + AT_STATED_SPEED)
    assert assert_well_formed(design) == {}
    phi = np.linspace(0.0, TURN, 500)
    assert not np.any(design.effect("vibration").output.deflection(phi, "right"))
    acceleration = in_time(design.cam.drive.plan.jet(phi), course_of(design), phi)[2]
    output = design.effect("vibration").output
    assert np.array_equal(output.acceleration(phi, "right"), acceleration)
    assert not np.any(design.effect("inertia").force.coefficients(phi, "right"))
    assert finding_of(design, "gravity", "weight").value == 0.0
    # Viscous friction in the guide is what is left of the speed: it pulls the roller off at last.
    tables = every(text, inertia="mass = 0") + AT_STATED_SPEED
    free = made(text, re.sub("guide_viscous = .*", "", tables))
    speed = finding_of(free, "lift-off", "lift-off-speed")
    assert (speed.value, speed.severity) == (None, "ok")


TOUCHING: Final = [
    # constant force, stiffness: the force at the top of the stroke is 0, and its slope too
    (10e-3 * (2.0 * math.pi) ** 2, 0.0),
    (9e-3 * (2.0 * math.pi) ** 2, 0.05e-3 * (2.0 * math.pi) ** 2),
]


@pytest.mark.parametrize(("preload", "stiffness"), TOUCHING)
def test_a_force_that_touches_zero_and_does_not_cross_it(preload: float, stiffness: float) -> None:
    """R = m s'' omega^2 + P + k s with s = h/2 (1 - cos phi).

    It is least at the top, P + k h - m h/2 omega^2. The spring is the least that keeps contact, and
    the speed that of lift-off, the jump speed of an eccentric as the textbooks on cam dynamics have
    it (Norton; Shigley and Uicker).
    """
    spring = f"[effects.spring]\npreload = {preload!r}\nstiffness = {stiffness!r}\n"
    further = "[effects.contact-force]\n[effects.lift-off]\n[effects.drive-torque]\n"
    pressure = "[effects.contact-pressure]\nwidth = 5\nrating = 900\n"
    design = made(HARMONIC, f"[effects.inertia]\nmass = 1\n{spring}{further}{pressure}")
    assert assert_well_formed(design) == {}
    largest = finding_of(design, "contact-force", "largest-contact-force")
    smallest = finding_of(design, "contact-force", "smallest-contact-force")
    assert smallest.value == pytest.approx(0.0, abs=ROUNDING * largest.value)
    assert all(each.severity in ("ok", "warning") for each in design.effects.findings("lift-off"))
    assert finding_of(design, "lift-off", "lift-off").severity == "ok"
    assert finding_of(design, "lift-off", "contact-touches-zero").cam_angle == pytest.approx(
        math.pi, abs=1e-4
    )
    assert "contact-lost" not in names_of(design, "drive-torque")
    speed = finding_of(design, "lift-off", "lift-off-speed")
    assert speed.value == pytest.approx(60.0, rel=1e-9)
    assert finding_of(design, "lift-off", "least-preload").value == pytest.approx(preload, rel=1e-9)
    least = finding_of(design, "lift-off", "least-stiffness").value
    assert least == pytest.approx(stiffness, rel=1e-9, abs=ROUNDING * preload)


def groove_with(share: float) -> Design:
    """A load of `share` of what makes the smallest force of the turn 0."""
    text = scene_text("groove")
    effects = "[effects.inertia]\nmoment_of_inertia = 0.01\n[effects.contact-force]\n"
    bare = made(text, effects).effect("contact-force")

    def needed(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(bare.required(phi, side)[2])

    load = -piecewise_extremes(needed, bare.edges).lowest.value * math.pi**2 * 1e-3
    return made(text, f"{effects}[effects.load]\nconstant = {share * load!r}\n[effects.lift-off]\n")


def test_a_groove_force_that_touches_zero_does_not_change_the_flank() -> None:
    for share in (1.0, 1.0001):
        design = groove_with(share)
        assert assert_well_formed(design) == {}
        (steady,) = design.effects.findings("lift-off")
        assert steady.value == 0.0
        assert "over the whole turn" in steady.sentence


@pytest.mark.parametrize("short", [1e-10, 1e-6, 1e-4, 1e-2])
def test_a_groove_force_that_barely_crosses_zero_changes_the_flank(short: float) -> None:
    """However short the stretch: its length goes with the root of what is missing."""
    design = groove_with(1.0 - short)
    assert assert_well_formed(design) == {}
    first, second = (each.cam_angle for each in design.effects.findings("lift-off"))
    assert first is not None
    assert second is not None
    # R'' / R is about (2 pi / span)^2 / 2 for a move of 100 degrees.
    assert 0.1 * math.sqrt(short) < second - first < 10.0 * math.sqrt(short)


def in_guide(coefficient: float, overhang: float = 60.0) -> str:
    return f"guide = {coefficient!r}\nguide_length = 40\nguide_overhang = {overhang!r}"


def jam(coefficient: float) -> Design:
    text = scene_text("plate_translating")
    return made(text, every(text, friction=in_guide(coefficient)))


def test_friction_near_the_limit_of_jamming() -> None:
    """Up to the coefficient at which the margin is 0 all effects answer; beyond it all say so."""
    text, low, high = scene_text("plate_translating"), 0.05, 3.0
    for _ in range(26):
        middle = 0.5 * (low + high)
        table = re.search(r"\[effects.friction\][^[]*", every(text, friction=in_guide(middle)))
        assert table is not None
        margin = finding_of(made(text, table[0]), "friction", "jamming-margin").value
        assert margin is not None
        low, high = (middle, high) if margin > 0.0 else (low, middle)
    below, above = jam(low * (1.0 - 1e-6)), jam(high * (1.0 + 1e-6))
    assert set(assert_well_formed(below)) <= {"speed-fluctuation"}
    assert finding_of(below, "friction", "jamming-margin").severity == "warning"
    # A force that grows as 1 / margin.
    largest = finding_of(below, "contact-force", "largest-contact-force").value
    assert largest > 1e3 * finding_of(jam(0.05), "contact-force", "largest-contact-force").value
    failed = assert_well_formed(above)
    for name in ("contact-force", "lift-off", "drive-torque", "contact-pressure"):
        assert failed[name] == "jamming"
        each = finding_of(above, name, "jamming")
        assert each.severity == "broken"
        assert each.cam_range is not None
    assert finding_of(above, "friction", "jamming-margin").severity == "broken"
    with pytest.raises(EffectError, match="jams"):
        above.effect("drive-torque")


def test_transmission_angle_0() -> None:
    """An offset as large as the base radius: the roller starts level with the cam axis.

    The design is no cam mechanism and a command stops there; asked all the same, effects say why.
    """
    text = changed(scene_text("plate_translating"), ("offset = 12", "offset = 50"))
    design = made(text, every(text, friction=""))
    assert any(each.severity == "invalid" for each in design.findings)
    for name in ("contact-force", "lift-off", "drive-torque", "contact-pressure"):
        each = finding_of(design, name, "jamming")
        assert (each.severity, each.value) == ("broken", 0.0)
    without = made(text, "[effects.load]\nconstant = 5\n[effects.contact-force]\n")
    assert "transmission angle is 0" in finding_of(without, "contact-force", "jamming").sentence
    margin = finding_of(made(text, "[effects.friction]\n"), "friction", "jamming-margin")
    assert margin.severity == "broken"
    assert margin.cam_angle == pytest.approx(math.radians(30.0), abs=1e-12)


@pytest.mark.parametrize("rev", ["1e4", "1e-3"])
def test_very_slow_and_very_fast_cams(rev: str) -> None:
    """Forces are c0 + c2 omega^2 to the last digits: nothing is lost at either end."""
    text = changed(scene_text("plate_translating"), ("speed = 60", f"speed = {rev}"))
    assert set(assert_well_formed(made(text, every(text)))) <= {"speed-fluctuation"}
    effects = "[effects.inertia]\nmass = 1\n[effects.contact-force]\n"
    here = made(text, effects).effect("contact-force")
    usual = made(scene_text("plate_translating"), effects).effect("contact-force")
    phi = np.linspace(0.0, TURN, 333) + 1e-3
    ratio = (float(rev) / 60.0) ** 2
    first, second = here.normal(phi, "right"), ratio * usual.normal(phi, "right")
    assert np.max(np.abs(first - second)) <= ROUNDING * np.max(np.abs(second))


def test_velocity_jumps() -> None:
    """Each effect with a mass reports the shock; the rest is finite."""
    stated = '[state]\nmotion = "demanded"\noutput = "rigid"\n\n[limits]'
    text = scene_text("straight_moves").replace("[limits]", stated)
    design = made(text, every(text))
    assert assert_well_formed(design) == {"speed-fluctuation": "shock"}
    for effect, name in (
        ("contact-force", "shock"),
        ("drive-torque", "shock"),
        ("speed-fluctuation", "shock"),
        ("inertia", "largest-inertia-force"),
        ("lift-off", "lift-off"),
    ):
        reported = [each for each in design.effects.findings(effect) if each.name == name]
        assert reported, effect
        assert all(each.severity in ("warning", "broken") for each in reported), effect
    # A train cushions it, except for what takes all masses as rigid.
    tables = every(text) if LONG else every(text).replace("[effects.lift-off]\n", "")
    soft = made(text.replace('output = "rigid"\n', ""), tables)
    assert assert_well_formed(soft) == {"speed-fluctuation": "shock"}
    assert "shock" not in names_of(soft, "contact-force") | names_of(soft, "drive-torque")
    # Without a mass there is no shock.
    still = made(text, every(text, inertia="mass = 0"))
    assert "shock" not in names_of(still, "contact-force") | names_of(still, "drive-torque")
    assert finding_of(still, "inertia", "largest-inertia-force").value == 0.0
    assert assert_well_formed(still) == {}


def test_a_light_shaft_whose_speed_all_but_stops_between_two_nodes() -> None:
    """The polynomials of a coarse mesh pass 0 there; the steady state is found all the same."""
    effects = """
[effects.inertia]
moment_of_inertia = 0.1028
[effects.spring]
stiffness = 57.58
preload = 3475
anchor = [-0.1198, -8.535]
attachment = [21.65, -67.26]
[effects.speed-fluctuation]
moment_of_inertia = 3.845e-06
no_load_speed = 425
stall_torque = 287.8
"""
    design = made(scene_text("trimmed_ring"), effects)
    assert assert_well_formed(design) == {}
    turn = design.effect("speed-fluctuation")
    assert np.min(turn.turn.omega(np.linspace(0.0, TURN, 5000))) > 0.0
    # Without friction and load the motor does no work over a turn.
    reported = {each.name: each.value for each in turn.findings}
    assert abs(reported["motor-work"]) <= 1e-5 * TURN * reported["largest-motor-torque"]


@pytest.mark.parametrize("name", ["plate_translating", "ring", "shuttle"])
def test_a_load_that_lifts_the_roller_off_everywhere(name: str) -> None:
    """Neither flank carries load: contact is lost all round at any speed; no pressure, no life."""
    text = with_speed(name)
    pull = {"plate_translating": "-1e4", "ring": "1e4", "shuttle": "-1e3"}[name]
    design = made(text, every(text, load=pull, friction="", stall="1e6"))
    assert assert_well_formed(design) == {}
    lost = finding_of(design, "lift-off", "lift-off")
    assert (lost.severity, lost.cam_range) == ("broken", (0.0, TURN))
    assert finding_of(design, "lift-off", "lift-off-speed").value == 0.0
    phi = np.linspace(0.0, TURN, 100)
    assert not np.any(design.effect("contact-pressure").columns[0].values(phi, "right"))
    assert "contact-lost" in names_of(design, "drive-torque")
