"""Kinematics in time: printed values, derivatives of derivatives, and what is infinite."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgeo.dynamics.effects.effect import Column
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.effects.scenes import course_of, design
from tests.findings import by_name, finding_values
from tests.integrals import cells, integrals

EFFECTS = "[effects.kinematics]\n"
PHI = np.linspace(0.0, TURN, 721)


def test_the_largest_values_are_those_of_the_law() -> None:
    """A modified sine of 20 mm in 100/360 s: C_v, C_a, C_j by differentiating the law by hand,
    4 pi/(4 + pi) = 1.75960, 4 pi^2/(4 + pi) = 5.52796 and 16 pi^3/(4 + pi) = 69.4664."""
    found = finding_values(design("plate_translating", EFFECTS).effect("kinematics").findings)
    span = 100.0 / 360.0
    unit = 4.0 + math.pi
    assert found["highest-velocity"] == pytest.approx(4 * math.pi / unit * 20 / span, rel=1e-13)
    c_a = 4 * math.pi**2 / unit
    assert found["highest-acceleration"] == pytest.approx(c_a * 20 / span**2, rel=1e-13)
    c_j = 16 * math.pi**3 / unit
    assert found["highest-jerk"] == pytest.approx(c_j * 20 / span**3, rel=1e-13)
    assert found["turn-time"] == pytest.approx(1.0, rel=1e-15)


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
