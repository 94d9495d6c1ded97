"""Checks of the motion plan: how it joins, whether it overshoots, how near it is to its data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
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
    told = [
        f"{float(start):g} to {float(end):g} deg {_made_of(segment)}"
        for segment, (start, end) in zip(plan.segments, pairwise(plan.joints_deg), strict=True)
        if segment.span and not isinstance(segment, Dwell)
    ]
    sentence = "; ".join(told[:LISTED]) + _more(told) if told else "the follower rests"
    return Finding("laws", "ok", sentence, float(len(told)))


def _more(listed: Sequence[object]) -> str:
    return f" and {len(listed) - LISTED} more" if len(listed) > LISTED else ""


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
    listed = ", ".join(f"{_angle(joint)}: {_both(joint)} C{joint.order}" for joint in met[:LISTED])
    sentence = f"the motion is at least C{worst} at its joints ({listed}{_more(met)})"
    return Finding("joints", "ok", sentence, float(worst))


LISTED = 12
"""Joints listed in a sentence."""


def _both(joint: Joint) -> str:
    before, after = joint.before, joint.after
    return f"{before}" if before == after else f"{before}|{after}"


def _angle(joint: Joint) -> str:
    return f"{math.degrees(joint.cam_angle):.6g} deg"


def _jump(joint: Joint, order: int, scale: float, unit: Unit) -> Finding:
    jump = scale * float(joint.right[order] - joint.left[order])
    place = f"at cam angle {_angle(joint)}"
    if order == 1:
        per = f"{unit}/rad"
        told = (
            f"the velocity jumps by {jump:.6g} {per} {place}, a shock: the acceleration is infinite"
        )
        return Finding("shock", "broken", told, jump, 0.0, per, joint.cam_angle)
    per = f"{unit}/rad^2"
    told = f"the acceleration jumps by {jump:.6g} {per} {place}"
    return Finding("jerk", "warning", told, jump, 0.0, per, joint.cam_angle)


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
            told = (
                f"the move by {move.law.name} goes {beyond:.6g} {unit} beyond its {what}, to"
                f" {scale * (position + stroke * extreme.value):.6g} {unit} at cam angle"
                f" {angle:.6g} deg"
            )
            place = math.radians(angle)
            found.append(Finding("overshoot", "warning", told, beyond, 0.0, unit, place))
    return found


def _deviation(course: Course, start: float, length: float, scale: float, unit: Unit) -> Finding:
    report = course.report
    assert report is not None  # asked for those only
    angle = start + report.place * length
    largest = scale * report.largest_deviation
    told = (
        f"the motion is at most {largest:.3g} {unit} off the rows of its lift table, at cam angle"
        f" {math.degrees(angle):.6g} deg (root of the mean square {scale * report.rms:.3g} {unit})"
    )
    return Finding("lift-table", "ok", told, largest, unit=unit, cam_angle=angle)
