"""Extremes of the motion, in time once the cam has a speed; there is no limit to hold them to."""

from __future__ import annotations

import math
from typing import Literal

from camgeo.check.finding import Finding
from camgeo.motion.joints import breaks
from camgeo.motion.law_extremes import plan_extremes
from camgeo.motion.plan import MotionPlan
from camgeo.motion.time_course import ConstantSpeed, TimeCourse
from camgeo.numeric.extremes import Extremes

Unit = Literal["mm", "deg"]

NAMES = ("velocity", "acceleration", "jerk")

OVER_ANGLE = ConstantSpeed(1.0)
"""At 1 rad/s derivatives over time are those over the cam angle."""


def check_speed(plan: MotionPlan, course: TimeCourse | None, unit: Unit) -> tuple[Finding, ...]:
    """Smallest and largest velocity, acceleration and jerk, and the torque that a mass asks for.

    Parameters
    ----------
    plan : in mm, or in rad with the `unit` "deg".
    course : how the cam turns; None tells the derivatives over the cam angle, and no torque.
    """
    extremes = plan_extremes(plan, course or OVER_ANGLE, "mm" if unit == "mm" else "rad")
    scale = 1.0 if unit == "mm" else math.degrees(1.0)
    base = "rad" if course is None else "s"
    order = min(joint.order for joint in breaks(plan))
    found = []
    for power, (name, values) in enumerate(
        zip(NAMES, (extremes.velocity, extremes.acceleration, extremes.jerk), strict=True), start=1
    ):
        per = f"{unit}/{base}" if power == 1 else f"{unit}/{base}^{power}"
        # Where a derivative jumps the next one is infinite.
        found.append(_finding(name, values, scale, per, bounded=order >= power - 1))
    if course is not None:
        per = "N m/kg" if unit == "mm" else "N m/(kg m^2)"
        found.append(_finding("inertia-torque", extremes.torque, 1.0, per, bounded=order >= 1))
    return tuple(found)


def _finding(name: str, values: Extremes, scale: float, unit: str, *, bounded: bool) -> Finding:
    low, high = values.lowest, values.highest
    worst = max(low, high, key=lambda end: abs(end.value))
    sentence = (
        f"from {scale * low.value:.6g} to {scale * high.value:.6g} {unit}, at cam angles"
        f" {math.degrees(low.place):.6g} and {math.degrees(high.place):.6g} deg"
    )
    if not bounded:
        jumps = "a shock" if name != "jerk" else "a shock or a jerk"
        sentence = f"infinite at {jumps}; elsewhere {sentence}"
        return Finding(f"largest-{name}", "ok", sentence, unit=unit)
    value = scale * worst.value
    return Finding(f"largest-{name}", "ok", sentence, value, unit=unit, cam_angle=worst.place)
