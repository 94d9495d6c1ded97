"""What a whole scene asks of its drive: the motion in time, and the torque with its flywheel."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgeo.dynamics.effects.drive_torque import moment_of_inertia, stored_energy
from camgeo.dynamics.effects.effect import Column
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray
from camgeo.units import RPM, TURN
from tests.effects.scenes import course_of, design
from tests.findings import by_name, finding_values
from tests.integrals import cells, integrals

EFFECTS = "[effects.kinematics]\n"
PHI = np.linspace(0.0, TURN, 721)


@pytest.mark.parametrize("scene", ["plate_translating", "points", "setzhub", "shuttle", "measured"])
def test_each_column_is_the_derivative_of_the_one_before(scene: str) -> None:
    """d/dt = omega d/dphi, integrated over cells: what velocity brings is the way, and so on."""
    made = design(scene, EFFECTS)
    found, course = by_name(made.effect("kinematics").columns), course_of(made)
    low, high = cells(made.drive.smooth_angles[:-1], 8)

    def over_time(column: Column) -> FloatArray:
        def per_angle(phi: FloatArray) -> FloatArray:
            rate: FloatArray = column.values(phi, "right") / course.rates(phi)[0]
            return rate

        return integrals(per_angle, low, high)

    for prefix in ("", "rocker ") if scene == "setzhub" else ("",):
        for before, after in (("velocity", "acceleration"), ("acceleration", "jerk")):
            first, second = found[prefix + before], found[prefix + after]
            change = first.values(high, "left") - first.values(low, "right")
            scale = np.max(np.abs(first.values(PHI, "right")))
            # Gauss's rule over an eighth of a piece; rounding of values in the cells.
            assert over_time(second) == pytest.approx(change, abs=1e-11 * scale)
    way = 1.0 if made.cam.lift_unit == "mm" or scene == "setzhub" else math.degrees(1.0)
    moves: list[tuple[str, Any, float]] = [("velocity", made.drive.plan, way)]
    if scene == "setzhub":
        moves.append(("rocker velocity", made.drive.motion, math.degrees(1.0)))
    for name, motion, unit in moves:
        moved = unit * (motion.jet(high, "left")[0] - motion.jet(low, "right")[0])
        largest = float(np.max(np.abs(motion.jet(PHI)[0]))) * unit
        assert over_time(found[name]) == pytest.approx(moved, abs=1e-11 * largest)
    times = found["time"].values(np.array([0.0, TURN]), "right")
    assert finding_values(made.effect("kinematics").findings)["turn-time"] == pytest.approx(
        times[1] - times[0], rel=1e-15
    )


@pytest.mark.parametrize("scene", ["plate_translating", "points", "setzhub", "schnitt", "feed"])
def test_nothing_is_beyond_the_extremes_and_they_are_taken(scene: str) -> None:
    made = design(scene, EFFECTS)
    found = by_name(made.effect("kinematics").columns)
    angles = np.concatenate((PHI, made.drive.smooth_angles))
    findings = by_name(made.effect("kinematics").findings)
    for name, column in found.items():
        if name == "time":
            continue
        key = name.replace(" ", "-")
        high, low = findings[f"highest-{key}"], findings[f"lowest-{key}"]
        sides = np.stack([column.values(angles, side) for side in ("right", "left")])
        slack = 1e-12 * max(abs(high.value), abs(low.value))
        assert np.max(sides) <= high.value + slack
        assert np.min(sides) >= low.value - slack
        for end in (high, low):
            place = np.array([end.cam_angle])
            taken = [column.values(place, side)[0] for side in ("right", "left")]
            # The place of a smooth extreme is known to the root of rounding.
            assert min(abs(value - end.value) for value in taken) <= 1e-9 * abs(end.value) + slack


def test_at_a_shock_acceleration_and_jerk_are_infinite() -> None:
    change = ('law = "modified-sine"', 'law = "straight-line"')
    made = design("plate_translating", EFFECTS, change)
    found = by_name(made.effect("kinematics").findings)
    # 20 mm in 100/360 s.
    assert found["highest-velocity"].value == pytest.approx(72.0, rel=1e-14)
    for name in ("highest-acceleration", "lowest-acceleration", "highest-jerk", "lowest-jerk"):
        assert found[name].value is None
        assert "infinite at a shock" in found[name].sentence
    for column in by_name(made.effect("kinematics").columns).values():
        assert np.all(np.isfinite(column.values(PHI, "right")))


# Drive torque: closed forms, its parts, and the flywheel ------------------------------------------
EPS = float(np.finfo(np.float64).eps)

CONSTANT = "[effects.load]\nconstant = 300\n"

SPRUNG = "[effects.inertia]\nmass = 2\n[effects.spring]\nstiffness = 4\npreload = 60\n"


def drive(scene: str, forces: str, table: str = "", *changes: tuple[str, str]) -> Any:
    made = design(scene, f"{forces}[effects.drive-torque]\n{table}", *changes)
    return made.effect("drive-torque")


def test_a_constant_load_takes_its_peak_where_the_velocity_does() -> None:
    """F s' at its largest: 4 pi / (4 + pi) h / beta for the modified sine (VDI 2143-1, C_v)."""
    rise = 4.0 * math.pi / (4.0 + math.pi) * 20.0 / math.radians(100.0)
    found = by_name(drive("plate_translating", CONSTANT, "fluctuation = 0.02").findings)
    # The extreme is sought by golden section: its value is exact except for rounding.
    assert found["largest-torque"].value == pytest.approx(300.0 * rise / 1000.0, rel=1e-13)
    # A parabola is flat to rounding within the square root of eps of its top.
    assert found["largest-torque"].cam_angle == pytest.approx(math.radians(80.0), abs=1e-6)
    # It stores F h on the way up and gives it back.
    assert found["energy-fluctuation"].value == pytest.approx(6.0, rel=1e-12)
    assert found["flywheel"].value == pytest.approx(6.0 / (0.02 * TURN**2), rel=1e-12)


def test_root_mean_square_with_a_speed_curve_is_over_time() -> None:
    made = design("points", f"{SPRUNG}[effects.drive-torque]\n")
    result, course = made.effect("drive-torque"), course_of(made)
    # Midpoints in time, of 1e5 parts: the error of a periodic C1 integrand is far below 1e-6.
    duration = float(np.diff(course.time(np.array([0.0, TURN])))[0])
    times = (np.arange(100_000) + 0.5) / 100_000 * duration
    grid = np.linspace(0.0, TURN, 200_001)
    phi = np.interp(times, course.time(grid) - course.time(grid[:1]), grid)
    rms = math.sqrt(float(np.mean(result.torque(phi, "right") ** 2))) / 1000.0
    assert by_name(result.findings)["rms-torque"].value == pytest.approx(rms, rel=1e-6)


def test_static_and_dynamic_parts() -> None:
    made = design("plate_translating", f"{SPRUNG}[effects.drive-torque]\n")
    result, phi = made.effect("drive-torque"), np.linspace(0.0, TURN, 721)
    s, s1, s2 = made.cam.drive.motion.jet(phi)[:3]
    static, dynamic = (60.0 + 4.0 * s) * s1, 2e-3 * TURN**2 * s2 * s1  # 60 rev/min
    scale = np.max(np.abs(static))
    found = [1e3 * each.values(phi, "right") for each in result.columns]
    for own, wanted in zip(found, (static + dynamic, static, dynamic), strict=True):
        assert np.max(np.abs(own - wanted)) <= 10.0 * EPS * scale
    at = result.torque_at_rates(phi, "right", 2.0 * TURN + 0.0 * phi, np.full(len(phi), 3.0))
    assert np.max(np.abs(at - static - 4.0 * dynamic - 6e-3 * s1**2)) <= 20.0 * EPS * scale


def test_without_speed_there_is_only_the_static_part() -> None:
    result = drive("ring", "[effects.load]\nconstant = -60\n")
    assert [each.name for each in result.columns] == ["drive torque"]
    assert not {"mean-power", "largest-static-torque"} & by_name(result.findings).keys()


def test_the_limit_holds_in_both_directions() -> None:
    found = by_name(drive("plate_translating", CONSTANT).findings)
    largest, smallest = (found[f"{name}-torque"].value for name in ("largest", "smallest"))
    assert largest > -smallest > 0.0
    between = 0.5 * (largest - smallest)
    result = drive("plate_translating", CONSTANT, f"limit = {between!r}")
    judged = by_name(result.findings)
    assert judged["largest-torque"].severity == "broken"
    assert judged["smallest-torque"].severity == "ok"
    assert judged["smallest-torque"].limit == pytest.approx(-between, rel=4.0 * EPS)
    assert result.columns[0].limit == pytest.approx(between, rel=4.0 * EPS)


def test_the_follower_jams_at_speeds_at_which_the_other_flank_carries() -> None:
    """The spring brings it back down a steep flank; at 950 rev/min a groove would have to."""
    steep = (("span = 100\n", "span = 170\n"), ("span = 120\n", "span = 50\n"))
    rubbing = "[effects.friction]\nguide = 0.5\nguide_length = 30\nguide_overhang = 60\n"
    result = drive("plate_translating", SPRUNG + rubbing, "", *steep, ("set = 12", "set = -12"))
    phi = np.linspace(0.0, TURN, 2001)
    with pytest.raises(EffectError, match="friction absorbs the entire contact force") as caught:
        result.torque_at_rates(phi, "right", np.full(len(phi), 100.0), np.zeros(len(phi)))
    assert (caught.value.finding, caught.value.unit) == ("jamming", "deg")
    assert caught.value.cam_angle is not None
    assert 240.0 < math.degrees(caught.value.cam_angle) < 290.0


def test_energy_of_a_torque_that_jumps() -> None:
    """On for a quarter of the turn: 3 / 4 of its work comes from the flywheel."""
    edges = np.array([0.0, 0.5 * math.pi, TURN])

    def torque(phi: FloatArray) -> FloatArray:
        return np.where(phi < 0.5 * math.pi, 8.0, 0.0)

    stored = stored_energy(torque, 2.0, 0.0, edges, 1e-13)
    assert stored.span == pytest.approx(6.0 * 0.5 * math.pi, rel=1e-14)


def test_flywheel_of_a_published_example() -> None:
    """Khurmi and Gupta, Theory of Machines, example 16.1: a flywheel of 6.5 t with 1.8 m radius of
    gyration stores 56 kN m at 120 rev/min; its speeds are 121 and 119 rev/min.
    """
    moment = 6500.0 * 1.8**2  # kg m^2
    swing = 56e6 / (1e3 * moment * (120.0 * RPM) ** 2)
    assert round(120.0 * (1.0 + 0.5 * swing)) == 121
    assert round(120.0 * (1.0 - 0.5 * swing)) == 119
    assert moment_of_inertia(56e6, swing, 120.0 * RPM) == pytest.approx(1e3 * moment, rel=1e-15)
