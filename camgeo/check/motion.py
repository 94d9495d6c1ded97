"""Checks of the motion plan: how it joins, whether it overshoots, how near it is to its data."""

from __future__ import annotations

import math
from typing import Literal

from camgeo.check.finding import Finding
from camgeo.motion.joints import Joint, breaks, joints
from camgeo.motion.laws.characteristic import characteristic
from camgeo.motion.plan import Course, Dwell, MotionPlan, Move

Unit = Literal["mm", "deg"]

OVERSHOOT = 1e-9
"""Part of the stroke beyond which a move overshoots; rounding stays a million times below."""

SHOCK, JERK = 0, 1
"""Orders up to which the motion is continuous where it has a shock, and where it has a jerk."""


def check_motion(plan: MotionPlan, unit: Unit) -> tuple[Finding, ...]:
    """Shocks (jumps of s'), jerks (jumps of s''), overshoots, and deviations from lift tables.

    Parameters
    ----------
    plan : in mm or rad.
    unit : of the findings, "deg" for a plan in rad.
    """
    scale = 1.0 if unit == "mm" else math.degrees(1.0)
    found = [_laws(plan), _continuity(plan)]
    for joint in breaks(plan):
        if joint.order == SHOCK:
            found.append(_jump(joint, 1, scale, unit))
        if joint.order in (SHOCK, JERK) and joint.left[2] != joint.right[2]:
            found.append(_jump(joint, 2, scale, unit))
    position = 0.0
    for segment, start in zip(plan.segments, plan.joints_deg, strict=False):
        angle = math.radians(float(segment.span))
        if isinstance(segment, Move) and segment.scale is None:
            found += _overshoot(segment, position, float(start), scale, unit)
        if isinstance(segment, Course) and segment.report is not None:
            found.append(_deviation(segment, math.radians(float(start)), angle, scale, unit))
        if isinstance(segment, Move | Course):
            position = segment.to
    return tuple(found)


def _laws(plan: MotionPlan) -> Finding:
    """What each move is made of, with what was chosen or worked out for it."""
    told = []
    for segment, start, end in zip(
        plan.segments, plan.joints_deg[:-1], plan.joints_deg[1:], strict=True
    ):
        if isinstance(segment, Dwell) or not segment.span:
            continue
        made = _made_of(segment)
        told.append(f"{float(start):g} to {float(end):g} deg {made}")
    more = f" and {len(told) - LISTED} more" if len(told) > LISTED else ""
    return Finding(
        name="laws",
        severity="ok",
        sentence="; ".join(told[:LISTED]) + more if told else "the follower rests",
        value=float(len(told)),
    )


def _made_of(segment: Move | Course) -> str:
    if isinstance(segment, Course):
        return "by data"
    law = segment.law
    given = ", ".join(f"{key} {value:.6g}" for key, value in law.parameters.items())
    return f"{law.name} {law.task}" + (f" ({given})" if given else "")


def _continuity(plan: MotionPlan) -> Finding:
    """The classes at all joints, and up to which derivative the motion is continuous there."""
    met = joints(plan)
    worst = min(joint.order for joint in met)
    listed = ", ".join(
        f"{_angle(joint)}: {joint.before if joint.before == joint.after else _both(joint)}"
        f" C{joint.order}"
        for joint in met[:LISTED]
    )
    more = f" and {len(met) - LISTED} more" if len(met) > LISTED else ""
    return Finding(
        name="joints",
        severity="ok",
        sentence=f"the motion is at least C{worst} at its joints ({listed}{more})",
        value=float(worst),
    )


LISTED = 12
"""Joints listed in a sentence."""


def _both(joint: Joint) -> str:
    return f"{joint.before}|{joint.after}"


def _angle(joint: Joint) -> str:
    return f"{math.degrees(joint.cam_angle):.6g} deg"


def _jump(joint: Joint, order: int, scale: float, unit: Unit) -> Finding:
    jump = scale * float(joint.right[order] - joint.left[order])
    per = "rad" if order == 1 else "rad^2"
    what = "velocity" if order == 1 else "acceleration"
    shock = ", a shock: the acceleration is infinite" if order == 1 else ""
    return Finding(
        name="shock" if order == 1 else "jerk",
        severity="broken" if order == 1 else "warning",
        sentence=(
            f"the {what} jumps by {jump:.6g} {unit}/{per} at cam angle {_angle(joint)}{shock}"
        ),
        value=jump,
        limit=0.0,
        unit=f"{unit}/{per}",
        cam_angle=joint.cam_angle,
    )


def _overshoot(
    move: Move, position: float, start: float, scale: float, unit: Unit
) -> list[Finding]:
    """How far a move leaves the positions between its start and its end."""
    stroke = move.to - position
    if stroke == 0.0:
        return []
    values = characteristic(move.law)
    found = []
    for excess, extreme, what in (
        (values.lift.value - 1.0, values.lift, "end"),
        (-values.least_lift.value, values.least_lift, "start"),
    ):
        if excess > OVERSHOOT:
            angle = start + extreme.place * float(move.span)
            beyond = scale * excess * abs(stroke)
            found.append(
                Finding(
                    name="overshoot",
                    severity="warning",
                    sentence=(
                        f"the move by {move.law.name} goes {beyond:.6g} {unit} beyond its {what},"
                        f" to {scale * (position + stroke * extreme.value):.6g} {unit}"
                        f" at cam angle {angle:.6g} deg"
                    ),
                    value=beyond,
                    limit=0.0,
                    unit=unit,
                    cam_angle=math.radians(angle),
                )
            )
    return found


def _deviation(course: Course, start: float, length: float, scale: float, unit: Unit) -> Finding:
    report = course.report
    assert report is not None  # asked for those only
    angle = start + report.place * length
    largest = scale * report.largest_deviation
    return Finding(
        name="lift-table",
        severity="ok",
        sentence=(
            f"the motion is at most {largest:.3g} {unit} off the rows of its lift table, at cam"
            f" angle {math.degrees(angle):.6g} deg (root of the mean square"
            f" {scale * report.rms:.3g} {unit})"
        ),
        value=largest,
        unit=unit,
        cam_angle=angle,
    )
