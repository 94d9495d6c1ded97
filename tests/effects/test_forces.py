"""Forces on the follower: inertia by Newton's law for single masses and by the energy of linkages,
gravity on a guide by hand, process loads by virtual work, and springs by their potential.
"""

from __future__ import annotations

import math
import shutil
from decimal import Decimal
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Final

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import DataFile, Subject
from camgeo.dynamics.effects.forces import at_rates
from camgeo.dynamics.effects.inertia import (
    LinkedTrain,
    at_cam,
    inertia_force,
    mass_train,
)
from camgeo.dynamics.effects.load import load_profile
from camgeo.dynamics.effects.results import Inertia
from camgeo.dynamics.effects.spring import PointSpring, slider_spring
from camgeo.dynamics.effects.spring_surge import CLEAR, FARTHEST
from camgeo.dynamics.effects.tables import (
    MassProperties,
    parse_inertia,
    parse_load,
    read_load_table,
)
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.plan import Dwell, MotionPlan
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import RPM, TURN
from tests.effects.scenes import SCENES, course_of, design
from tests.findings import finding
from tests.integrals import cells, integrals
from tests.strategies import SMOOTH, attack, plans, slider_cranks

ROUNDING = 1e-11
"""As a share of the largest value. The linkages drawn keep 2 mm from closing, so that by
sin(v - theta) >= 0.1 is divided twice, in rates of 1e-14; they keep off cos v = 0 by 0.05."""

PHI = np.linspace(0.0, TURN, 721)
STROKE = 8.0


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


# Single masses --------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", ["plate_translating", "feed", "measured", "points"])
@pytest.mark.parametrize("side", ["right", "left"])
def test_a_translating_follower_obeys_newton(scene: str, side: Any) -> None:
    """-m (s'' omega^2 + s' alpha) [N], 0.9 kg; with a speed curve the latter is not to be lost."""
    result, subject = inertia_of(scene, "[effects.inertia]\nmass = 0.8\nroller_mass = 0.1\n")
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
    result, subject = inertia_of(
        "groove", "[effects.inertia]\nmoment_of_inertia = 0.02\nroller_mass = 0.1\n"
    )
    assert result.moved == pytest.approx(20.64, rel=1e-14)
    assert finding(result.findings, "reduced-moment-of-inertia").value == pytest.approx(
        0.02064, rel=1e-14
    )
    jet = subject.cam.drive.motion.jet(PHI)
    coefficients = result.force.coefficients(PHI, "right")
    assert not np.any(coefficients[:2])
    assert coefficients[2:] == pytest.approx(-20.64 * jet[[2, 1]], rel=1e-14)


def test_without_any_mass_there_is_no_force() -> None:
    result, subject = inertia_of("setzhub", "[effects.inertia]\n")
    assert not np.any(result.force.coefficients(PHI, "right"))
    assert not np.any(at_cam(mass_train(subject, parse_inertia({})), PHI, "right"))
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
    effects = (
        "[effects.inertia]\nmass = 1.5\nmoment_of_inertia = 0.02\nroller_mass = 0.1\n"
        "coupler_mass = 0.4\ncoupler_centre = 0.4\ncoupler_moment = 0.001\n"
        "rocker_mass = 0.7\nrocker_centre = [10, 20]\n"
    )
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


# Gravity on a guide; behind linkages test_pins has it ---------------------------------------------


def force(made: Any) -> FloatArray:
    """(721,) c0 on the follower."""
    coefficients = made.effect("gravity").force.coefficients(PHI, "right")
    assert not np.any(coefficients[1:])
    found: FloatArray = coefficients[0]
    return found


FAST = (('rotation = "ccw"', 'rotation = "ccw"\nspeed = 60'),)  # for the ring, which has none


@pytest.mark.parametrize(
    ("scene", "changes", "angle", "expected"),
    [
        ("plate_translating", (), -90.0, -1.0),  # outward is up
        ("plate_translating", (('direction = "outward"', 'direction = "inward"'),), -90.0, 1.0),
        ("plate_translating", (), 90.0, 1.0),
        ("plate_translating", (), 0.0, 0.0),
        ("plate_translating", (), -60.0, -math.sqrt(0.75)),
        ("ring", FAST, -90.0, 0.0),  # outward is to the right
        ("ring", FAST, 0.0, 1.0),
        ("ring", FAST, 180.0, -1.0),
    ],
)
def test_on_a_guide_the_share_along_it_counts(
    scene: str, changes: Any, angle: float, expected: float
) -> None:
    """Of 0.9 kg; 1 kg weighs 9.80665 N (3rd CGPM 1901)."""
    made = design(
        scene,
        f"[effects.inertia]\nmass = 0.8\nroller_mass = 0.1\n[effects.gravity]\nangle = {angle}\n",
        *changes,
    )
    # The cosine of 90 degrees is 6e-17.
    assert force(made) == pytest.approx(np.full(721, 0.9 * 9.80665 * expected), abs=1e-14)
    weight = made.effect("gravity").findings[0]
    assert (weight.name, weight.unit) == ("weight", "N")
    assert weight.value == pytest.approx(0.9 * 9.80665, rel=4e-16)


def test_without_masses_nothing_weighs() -> None:
    made = design("groove", "[effects.inertia]\n[effects.gravity]\n")
    assert not np.any(force(made))
    assert [each.value for each in made.effect("gravity").findings] == [0.0, 0.0, 0.0]


# Loads --------------------------------------------------------------------------------------------


def c0(made: Design, phi: FloatArray = PHI, side: Any = "right") -> FloatArray:
    coefficients = made.effect("load").force.coefficients(phi, side)
    assert not np.any(coefficients[1:])
    found: FloatArray = coefficients[0]
    return found


@pytest.mark.parametrize(
    ("scene", "unit"),
    [("plate_translating", 1.0), ("groove", 1e3), ("setzhub", 1.0), ("schnitt", 1.0)],
)
def test_a_constant_load_works_against_a_positive_motion(scene: str, unit: float) -> None:
    """Virtual work: c0 q' = -F s'; of a rocker it is a torque, behind a linkage a force on the
    slider; and it is there in the rests.
    """
    made = design(scene, "[effects.load]\nconstant = 80\n")
    swing, stroke = made.cam.drive.motion.jet(PHI), made.cam.drive.plan.jet(PHI)
    work = -80.0 * unit * stroke[1]
    assert c0(made) * swing[1] == pytest.approx(work, abs=1e-13 * np.max(np.abs(work)))
    assert np.min(np.abs(c0(made))) > 0.0
    (column,) = made.effect("load").columns
    assert column.unit == ("N" if unit == 1.0 else "N m")
    assert np.array_equal(column.values(PHI, "right"), np.full(721, 80.0))


def test_segments_have_each_their_own() -> None:
    """plate_translating: 30, 100, 40, 120, 70 degrees; the side decides at a joint."""
    made = design("plate_translating", "[effects.load]\nsegments = [1, 2, 3, 4, 5]\n")
    joints = np.radians([0.0, 30.0, 130.0, 170.0, 290.0])
    assert np.array_equal(c0(made, joints), [-1.0, -2.0, -3.0, -4.0, -5.0])
    assert np.array_equal(c0(made, joints, "left"), [-5.0, -1.0, -2.0, -3.0, -4.0])
    assert np.array_equal(c0(made, joints + 0.1), c0(made, joints))
    assert np.array_equal(c0(made, np.array([TURN]), "left"), [-5.0])
    assert np.array_equal(c0(made, np.array([TURN]), "right"), [-1.0])
    result = made.effect("load")
    assert result.force.borders == pytest.approx(joints, abs=1e-15)
    assert [each.value for each in result.findings] == [5.0, 1.0]
    # Work over a turn: 2 N against 20 mm up, 4 N with 20 mm down.
    low, high = cells(made.drive.smooth_angles[:-1], 6)
    work = np.sum(
        integrals(lambda phi: c0(made, phi) * made.cam.drive.motion.jet(phi)[1], low, high)
    )
    assert work == pytest.approx(-2.0 * 20.0 + 4.0 * 20.0, rel=1e-13)


def test_a_rest_of_no_length_has_no_load() -> None:
    """The rest of 40 degrees is cut into 40 and 0."""
    cut = ("dwell = 40\n", "dwell = 40\n\n[[motion]]\ndwell = 0\n")
    made = design("plate_translating", "[effects.load]\nsegments = [1, 2, 3, 4, 5]\n", cut)
    joints = np.radians([0.0, 30.0, 130.0, 170.0, 290.0])
    assert np.array_equal(c0(made, joints), [-1.0, -2.0, -3.0, -4.0, -5.0])
    assert np.array_equal(c0(made, joints, "left"), [-5.0, -1.0, -2.0, -3.0, -4.0])
    still = Dwell(Decimal(0)), Dwell(Decimal(120)), Dwell(Decimal(0)), Dwell(Decimal(240))
    steps = load_profile((7.0, 8.0), MotionPlan(still), "N")
    angles = np.radians([0.0, 120.0])
    assert np.array_equal(steps.values(angles, "right"), [7.0, 8.0])
    assert np.array_equal(steps.values(angles, "left"), [8.0, 7.0])


# Files ----------------------------------------------------------------------------------------

ROWS = "phi [deg];F [N]\n0;10\n90;40\n100;-20\n360;30\n"


def table(text: str) -> Any:
    return read_load_table(DataFile("load.csv", text.encode()))


def test_between_rows_there_are_straight_lines() -> None:
    found = table(ROWS)
    angles = np.radians([0.0, 45.0, 90.0, 95.0, 100.0, 230.0, 360.0])
    expected = [10.0, 25.0, 40.0, 10.0, -20.0, 5.0, 10.0]
    assert found.values(angles, "right") == pytest.approx(expected, abs=1e-12)
    expected[0] = expected[-1] = 30.0  # the value at 360 is not that at 0: it jumps
    assert found.values(angles, "left") == pytest.approx(expected, abs=1e-12)
    assert found.borders == pytest.approx(np.radians([0.0, 90.0, 100.0]), abs=1e-15)
    assert found.values(angles[1:2] + TURN, "right") == pytest.approx([25.0], abs=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1;2\n360;3\n", r"load\.csv, line 1: '1\.0': the first angle is not 0; allowed: 0"),
        ("0;2\n350;3\n", r"line 2: '350\.0': the last angle is not a full turn; allowed: 360"),
        (
            "0;2\n90;1\n90;3\n360;3\n",
            r"line 3: '90\.0': the angle does not exceed the one before, 90\.0",
        ),
        ("0;2\n90;x\n360;3\n", r"line 2: 'x': not a number"),
        ("phi [rad];F\n0;2\n360;3\n", "the unit of the angle is unknown; allowed: deg"),
        ("phi;F [kg]\n0;2\n360;3\n", "the unit of the load is unknown; allowed: N or Nm"),
    ],
)
def test_a_wrong_row_is_reported_with_its_line(text: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        parse_load({"file": DataFile("load.csv", text.encode())})
    assert caught.value.key == "file"


def scene_with(folder: Path, rows: str, scene: str = "plate_translating") -> Design:
    shutil.copy(SCENES / f"{scene}.toml", folder / "cam.toml")
    (folder / "load.csv").write_text(rows, "utf-8")
    with (folder / "cam.toml").open("a", encoding="utf-8") as file:
        file.write('\n[effects.load]\nfile = "load.csv"\n')
    return Design(load_scene(folder / "cam.toml"))


def test_a_file_of_a_scene_gives_the_force(tmp_path: Path) -> None:
    made = scene_with(tmp_path, ROWS)
    angles = np.radians([0.0, 45.0, 95.0])
    assert c0(made, angles) == pytest.approx([-10.0, -25.0, -10.0], abs=1e-12)
    assert c0(made, angles[:1], "left") == pytest.approx([-30.0], abs=1e-12)
    largest, smallest = made.effect("load").findings
    assert (largest.value, smallest.value) == (40.0, -20.0)
    assert largest.cam_angle == pytest.approx(np.radians(90.0), rel=1e-15)


def test_a_heading_in_another_unit_is_refused(tmp_path: Path) -> None:
    made = scene_with(tmp_path, "phi,M [Nm]\n0,1\n360,1\n")
    with pytest.raises(GeometryError, match="loads in N m") as caught:
        made.effect("load")
    assert caught.value.key == "effects.load.file"


def test_a_file_of_torques_loads_a_rocker(tmp_path: Path) -> None:
    made = scene_with(tmp_path, "angle,torque [N m]\n0,1\n360,2\n", "groove")
    assert c0(made, np.array([np.pi])) == pytest.approx([-1500.0], rel=1e-14)


LINEAR: Final = "stiffness = 5\npreload = 50\n"
TORSION: Final = 'kind = "torsion"\ntorsional_stiffness = 5\npreload_torque = 50\n'

ENDS: Final = "anchor = [30, -60]\nattachment = [60, 30]\n"

SPRINGS: Final = {
    "guide": ("plate_translating", LINEAR),
    "guide, outer flank": ("ring", LINEAR),
    "guide, lift from a table": ("measured", LINEAR),
    "slider that draws": ("setzhub", LINEAR),
    "slider that pushes": ("schnitt", LINEAR),
    "torsion": ("shuttle", TORSION),
    "torsion in a groove": ("groove", TORSION),
    "torsion with a linkage": ("setzhub", TORSION),
    "extension": ("shuttle", 'kind = "extension"\n' + LINEAR + ENDS),
    "compression": ("groove", LINEAR + ENDS),
    "compression with a linkage": ("schnitt", LINEAR + ENDS),
}

WOUND: Final = {"diameter": 3.0, "coil_diameter": 24.0, "active_coils": 6.0, "free_length": 60.0}
"""Its coils touch at 24 mm."""

FEW_ROUNDINGS: Final = 1e-13
"""Some hundred roundings of the numbers at hand."""


def spring_of(name: str) -> tuple[Design, Any]:
    scene, table = SPRINGS[name]
    made = design(scene, f"[effects.spring]\n{table}")
    return made, made.effect("spring")


def grid(made: Design) -> FloatArray:
    """Angles all round, with those where the formula changes."""
    found: FloatArray = np.concatenate((np.linspace(0.0, TURN, 361), made.drive.smooth_angles))
    return found


@pytest.mark.parametrize("name", SPRINGS)
def test_the_force_is_the_slope_of_the_potential(name: str) -> None:
    """c0 q' = -dV/dphi, integrated from place to place, so that no difference blurs it."""
    made, spring = spring_of(name)
    low, high = cells(made.cam.drive.motion.borders, 12)

    def power(phi: FloatArray) -> FloatArray:
        found: FloatArray = (
            spring.force.coefficients(phi, "right")[0] * made.cam.drive.motion.jet(phi)[1]
        )
        return found

    work = integrals(power, low, high)

    def potential(phi: FloatArray, side: Side) -> Any:
        x = spring.way(phi, side)[0]
        return (0.5 * spring.stiffness * x - spring.preload) * x

    loss = potential(low, "right") - potential(high, "left")
    scale = np.max(np.abs(potential(grid(made), "right")))
    # The rule of 24 points is exact to rounding on a twelfth of a law.
    assert np.max(np.abs(work - loss)) <= 1e-11 * scale
    phi = grid(made)
    peak = np.max(
        np.abs(spring.force.coefficients(phi, "right")[0] * made.cam.drive.motion.jet(phi)[1])
    )
    assert abs(np.sum(work)) <= 1e-12 * peak
    assert np.all(spring.force.coefficients(phi, "right")[1:] == 0.0)


@pytest.mark.parametrize("name", SPRINGS)
def test_the_force_is_linear_in_preload_and_stiffness(name: str) -> None:
    made, spring = spring_of(name)
    for side in ("right", "left"):
        phi = grid(made)
        parts = spring.preload * spring.per_preload(phi, side)
        parts += spring.stiffness * spring.per_stiffness(phi, side)
        found = spring.force.coefficients(phi, side)[0]
        assert parts == pytest.approx(found, abs=FEW_ROUNDINGS * float(np.max(np.abs(found))))


@pytest.mark.parametrize(
    "name", [name for name, (_, table) in SPRINGS.items() if ENDS not in table]
)
def test_it_presses_the_roller_to_its_flank(name: str) -> None:
    """The preload alone, whatever the motion: against the outward normal, or along it."""
    made, spring = spring_of(name)
    phi = grid(made)
    outwards = spring.per_preload(phi, "right") / made.cam.disc.pitch_curve.leverage(phi)
    assert np.all(outwards > 0.0 if made.cam.contact == "outer" else outwards < 0.0)
    assert "spring-opens-contact" not in {found.name for found in spring.findings}


def test_a_lift_of_more_than_the_deflection_by_the_preload_makes_it_slack() -> None:
    """F = P - k s on the ring, whose lift is 12.5 mm, and 10 mm are those of the preload."""
    made, spring = spring_of("guide, outer flank")
    slack = finding(spring.findings, "slack-spring")
    assert (slack.severity, slack.value) == ("warning", pytest.approx(-12.5))
    ends = made.cam.drive.motion.jet(np.array(slack.cam_range))
    assert ends[0] == pytest.approx([10.0, 10.0], abs=1e-12)
    assert ends[1][0] > 0.0 > ends[1][1]


@pytest.mark.parametrize(
    ("name", "sense", "unit"),
    [
        ("guide", -1.0, 1.0),  # outwards, of an inner flank
        ("guide, outer flank", 1.0, 1.0),
        ("torsion in a groove", 1.0, 1e3),  # inwards: the spring relaxes
        ("slider that draws", 1.0, 1.0),  # inwards, of an inner flank
        ("slider that pushes", -1.0, 1.0),
    ],
)
def test_along_one_way_it_does_the_work_of_its_end(name: str, sense: float, unit: float) -> None:
    """Q q' = F ds/dphi in the sense in which it closes: virtual work, without the linkage."""
    made, spring = spring_of(name)
    phi = grid(made)
    stroke, speed = made.cam.drive.plan.jet(phi)[:2]
    force = 50.0 - 5.0 * sense * stroke
    work = spring.force.coefficients(phi, "right")[0] * made.cam.drive.motion.jet(phi)[1]
    wanted = sense * unit * force * speed
    assert work == pytest.approx(wanted, abs=1e-11 * float(np.max(np.abs(wanted))))
    (column,) = spring.columns
    assert column.unit == ("N" if unit == 1.0 else "N m")
    assert column.values(phi, "right") == pytest.approx(force)


@pytest.mark.parametrize(
    ("name", "pivot", "sense"),
    [("extension", 110.0, -1.0), ("compression", -96.0 - 72.0j, 1.0)],
)
def test_between_two_points(name: str, pivot: complex, sense: float) -> None:
    """The moment of the spring's force about the pivot, from where its end is in the drawing."""
    made, spring = spring_of(name)
    phi = grid(made)
    lift = made.cam.drive.motion.jet(phi)[0]
    turn = np.exp(1j * made.cam.follower.reach / abs(made.cam.follower.reach) * lift)
    anchor, first = 30.0 - 60.0j, 60.0 + 30.0j
    end = pivot + (first - pivot) * turn
    longer = np.abs(end - anchor) - abs(first - anchor)
    force = (50.0 - sense * 5.0 * longer) * sense * (end - anchor) / np.abs(end - anchor)
    moment = np.imag(np.conj(end - pivot) * force)
    wanted = moment * made.cam.follower.reach / abs(made.cam.follower.reach)
    found = spring.force.coefficients(phi, "right")[0]
    assert found == pytest.approx(wanted, abs=1e-12 * float(np.max(np.abs(wanted))))


def test_pulling_instead_of_pushing_opens_the_contact() -> None:
    """One of the two must: both act along the same line."""
    opened = {}
    for kind in ("extension", "compression"):
        made = design("shuttle", f'[effects.spring]\nkind = "{kind}"\n{LINEAR}{ENDS}')
        found = made.effect("spring").findings
        opened[kind] = [each for each in found if each.name == "spring-opens-contact"]
    assert not opened["compression"]
    (told,) = opened["extension"]
    assert (told.severity, told.cam_range) == ("warning", (0.0, TURN))


coordinates = st.complex_numbers(min_magnitude=1.0, max_magnitude=1e3, allow_nan=False)


@settings(max_examples=60, deadline=None)
@given(anchor=coordinates, attachment=coordinates, swing=st.floats(1e-3, 1.5))
def test_a_tiny_elongation_keeps_its_digits(
    anchor: complex, attachment: complex, swing: float
) -> None:
    """Against 40 digits, from swings of 1e-12 to 1.5 rad."""
    for size in (1e-9, -1e-3, 1.0):
        angle = swing * size
        if abs(attachment - anchor) < 1.0 or abs(attachment * np.exp(1j * angle) - anchor) < 1.0:
            continue
        motion: Any = SimpleNamespace(jet=lambda *_, q=angle: np.array([[q], [0.0]]))
        way = PointSpring(motion, 0.0, 1, attachment, anchor, 1.0)
        found = way(np.zeros(1), "right")[0][0]
        with mpmath.workdps(40):
            r, a = mpmath.mpc(attachment), mpmath.mpc(anchor)
            wanted = abs(r * mpmath.expj(mpmath.mpf(angle)) - a) - abs(r - a)
            # Im(conj(a) r) and sin(half) are rounded each, no difference of lengths is.
            slack = 16.0 * 2.0**-52 * abs(angle) * abs(a) * abs(r) / abs(r - a)
            assert abs(found - wanted) <= slack + 16.0 * 2.0**-52 * abs(wanted)


def test_an_arm_over_the_line_of_centres_cannot_close_by_the_slider() -> None:
    made = design("schnitt", f"[effects.spring]\n{LINEAR}")
    linkage = made.cam.drive.linkage
    assert isinstance(linkage, SliderCrank)
    follower: Any = SimpleNamespace(
        reach=1.0, ahead=0,
        relative_jet=lambda jet, *_: SimpleNamespace(u=jet[0] - 0.5 * np.max(jet[0])),
    )  # fmt: skip
    plan = made.cam.drive.plan
    state = SimpleNamespace(output=plan, motion=plan, smooth_angles=made.drive.smooth_angles)
    subject: Any = SimpleNamespace(cam=SimpleNamespace(rotation=1, follower=follower), state=state)
    with pytest.raises(GeometryError, match="line of centres") as error:
        slider_spring(subject, linkage)
    assert error.value.key == "effects.spring"


def helical(**changed: float | str) -> tuple[Any, dict[str, Any]]:
    """The spring `WOUND` along a guide with a lift of 20 mm, and its findings."""
    keys = "\n".join(f"{key} = {value!r}" for key, value in (WOUND | changed).items())
    table = f"[effects.spring]\npreload = 50\n[effects.spring.wire]\n{keys}\n"
    spring = design("plate_translating", table).effect("spring")
    return spring, {each.name: each for each in spring.findings}


def test_a_helical_spring_acts_as_one_of_its_stiffness() -> None:
    """And its stress is what its force does, all round."""
    spring, found = helical()
    stated = design(
        "plate_translating", f"[effects.spring]\npreload = 50\nstiffness = {spring.stiffness!r}\n"
    )
    phi = grid(stated)
    plain = stated.effect("spring")
    for side in ("right", "left"):
        same = plain.force.coefficients(phi, side)
        assert np.array_equal(spring.force.coefficients(phi, side), same)
    assert spring.findings[:3] == plain.findings
    force, stress = (column.values(phi, "right") for column in spring.columns)
    # C = 8, so K = 31/28 + 0.615/8.
    per_force = (31.0 / 28.0 + 0.615 / 8.0) * 8.0 * 24.0 / (math.pi * 27.0)
    assert stress == pytest.approx(per_force * force, rel=FEW_ROUNDINGS)
    assert found["largest-spring-stress"].value == pytest.approx(float(np.max(stress)))
    assert {each.severity for each in spring.findings} == {"ok"}


def test_what_a_helical_spring_cannot_bear_is_said() -> None:
    """Limits on either side of the values found."""
    _, found = helical()
    largest, solid = found["largest-spring-stress"].value, found["solid-spring-stress"].value
    assert solid > largest
    for strength, judged in (
        (0.999 * largest, ("broken", "warning")),
        (0.999 * solid, ("ok", "warning")),
        (1.001 * solid, ("ok", "ok")),
    ):
        _, told = helical(strength=strength)
        names = ("largest-spring-stress", "solid-spring-stress")
        assert tuple(told[name].severity for name in names) == judged
    force = found["largest-spring-force"].value
    for deflections, severity in ((0.99, "broken"), (1.14, "warning"), (1.16, "ok")):
        length = 24.0 + deflections * force / helical()[0].stiffness
        assert helical(free_length=length)[1]["spring-closure"].severity == severity
    # 2.63 times 24 mm, divided by the effective length of each pair of seats.
    for seats, alpha in (
        ("flat", 0.5),
        ("flat-hinged", 0.707),
        ("hinged", 1.0),
        ("flat-free", 2.0),
    ):
        for share, severity in ((0.999, "ok"), (1.001, "warning")):
            length = share * 2.63 * 24.0 / alpha
            told = helical(free_length=length, seats=seats)[1]
            assert told["spring-buckling"].severity == severity
    assert helical(coil_diameter=37.0)[1]["spring-index"].severity == "warning"


# Spring surge: harmonics of the travel ------------------------------------------------------------


LIFT: Final = 20.0

WIRE: Final = (
    "[effects.spring]\npreload = 50\n[effects.spring.wire]\ndiameter = 3\ncoil_diameter = 24\n"
    "active_coils = 6\nfree_length = 90\n"
)

SCENE: Final = """
camgeo = 1
name = "surge"
[cam]
rotation = "cw"
speed = {speed!r}
[follower]
kind = "translating-roller"
base_radius = 60
roller_radius = 10
[[motion]]
law = "{law}"
span = 180
to = {lift!r}
[[motion]]
law = "{law}"
span = 180
to = 0
[effects.spring-surge]
tolerance = 1e-9
"""

FREQUENCY: Final = math.sqrt(79300.0 / (2.0 * 7.85e-9)) * 3.0 / (24.0**2 * 6.0)
"""2 pi f_1 [rad/s] of that spring: d/(2 pi D^2 n) sqrt(G/(2 rho)) is f_1."""


def surge(law: str, speed: float) -> tuple[Any, dict[str, Any]]:
    """At `speed` [rev/min], up and down over half a turn each, and its findings."""
    text = SCENE.format(law=law, speed=speed, lift=LIFT) + WIRE
    result = Design(parse_scene(text, "surge.toml")).effect("spring-surge")
    return result, {each.name: each for each in result.findings}


@pytest.mark.parametrize("order", [1, 2, 7, 16, 101])
def test_harmonics_in_closed_form(order: int) -> None:
    """Of a cosine only the first one; of parabolas the odd ones fall with the cube.

    The acceleration per angle is A = 4 h/pi^2 up and down, a square wave with harmonics 4 A/(pi n),
    and n^2 times less is the travel's.
    """
    speed = 1.004 * FREQUENCY / order / RPM
    for law, wanted in (
        ("simple-sine", 0.5 * LIFT if order == 1 else 0.0),
        ("quadratic-parabola", 16.0 * LIFT / (math.pi * order) ** 3 * (order % 2)),
    ):
        result, found = surge(law, speed)
        assert result.harmonic.order == order
        bound = result.errors["surge-harmonic"]
        assert bound.scale == pytest.approx(0.5 * LIFT)
        assert bound.error <= 1e-9 * bound.scale
        assert abs(found["surge-harmonic"].value - wanted) <= bound.error + 1e-15 * LIFT


def test_the_frequency_and_what_is_too_near_it() -> None:
    for times in (0.3, 0.999 * CLEAR, 1.001 * CLEAR, 0.999 * FARTHEST, 1.001 * FARTHEST):
        result, found = surge("simple-sine", FREQUENCY / times / RPM)
        frequency = found["surge-frequency"]
        assert frequency.value == pytest.approx(FREQUENCY / TURN, rel=1e-12)
        assert frequency.severity == ("ok" if times > CLEAR else "warning")
        assert frequency.limit == pytest.approx(CLEAR / times * frequency.value)
        if times > FARTHEST:
            assert result.harmonic is None
        else:
            assert result.harmonic.order == max(1, round(times))


def test_a_cam_that_turns_unevenly() -> None:
    """Against the integral of the travel over time, not by parts, for a low harmonic."""
    made = design(
        "points", "[effects.spring-surge]\ntolerance = 1e-10\n" + WIRE + "density = 1e6\n"
    )
    course = course_of(made)
    result = made.effect("spring-surge")
    order, way = result.harmonic.order, made.effect("spring").way
    duration = TURN / result.speed

    def wave(phi: FloatArray) -> Any:
        phase = np.exp(-1j * order * TURN * course.time(phi) / duration)
        return way(phi, "right")[0] * phase / course.rates(phi)[0]

    borders = np.unique(np.concatenate((made.drive.motion.borders, course.borders)))
    wanted = 2.0 / duration * abs(np.sum(integrals(wave, *cells(borders, order))))
    assert result.harmonic.amplitude == pytest.approx(wanted, abs=1e-9 * result.harmonic.travel)
