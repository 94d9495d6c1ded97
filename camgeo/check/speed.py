"""Physical extremes of the motion, once the cam has a speed; there is no limit to hold them to."""

from __future__ import annotations

import math
from typing import Literal

from camgeo.check.finding import Finding
from camgeo.motion.law_extremes import extremes_at_turns
from camgeo.motion.plan import MotionPlan
from camgeo.motion.time_course import ConstantSpeed, LiftUnit, TimeCourse, time_extremes

Unit = Literal["mm", "deg"]


def check_speed(plan: MotionPlan, course: TimeCourse, unit: Unit) -> tuple[Finding, ...]:
    """Largest velocity, acceleration and jerk in time, and the torque that a mass asks for.

    Parameters
    ----------
    plan : in mm, or in rad with the `unit` "deg".
    course : how the cam turns.
    """
    lift_unit: LiftUnit = "mm" if unit == "mm" else "rad"
    extremes = None
    if isinstance(course, ConstantSpeed):
        extremes = extremes_at_turns(plan, course, lift_unit)
    if extremes is None:
        extremes = time_extremes(plan, course, lift_unit)
    scale = 1.0 if unit == "mm" else math.degrees(1.0)
    torque = "N m/kg" if unit == "mm" else "N m/(kg m^2)"
    rows = (
        ("velocity", extremes.velocity, scale, f"{unit}/s"),
        ("acceleration", extremes.acceleration, scale, f"{unit}/s^2"),
        ("jerk", extremes.jerk, scale, f"{unit}/s^3"),
        ("inertia-torque", extremes.torque, 1.0, torque),
    )
    found = []
    for name, values, factor, per in rows:
        low, high = values.lowest, values.highest
        worst = max(low, high, key=lambda end: abs(end.value))
        found.append(
            Finding(
                name=f"largest-{name}",
                severity="ok",
                sentence=(
                    f"from {factor * low.value:.6g} to {factor * high.value:.6g} {per}, at cam"
                    f" angles {math.degrees(low.place):.6g} and {math.degrees(high.place):.6g} deg"
                ),
                value=factor * worst.value,
                unit=per,
                cam_angle=worst.place,
            )
        )
    return tuple(found)
