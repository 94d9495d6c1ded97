"""The load as a force on the follower."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column, Request, Subject, demand_unit
from camgeo.effects.force import Force
from camgeo.effects.load.course import Constant
from camgeo.effects.locked import refuse_locked
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extreme
from camgeo.numeric.peaks import piecewise_extremes
from camgeo.units import TURN

N_MM: Final = 1e3
"""N mm a N m."""


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """What `compute` gives.

    Attributes
    ----------
    force : the generalised force on the follower [N or N mm], c0 alone. A constant load has a
        potential energy F s [N mm]; others do work over a turn and have none.
    findings, columns, error : see `camgeo.effects.effect.Result`.
    """

    force: Force
    findings: tuple[Finding, ...]
    columns: tuple[Column, ...]
    error: None = None


def compute(request: Request) -> Load:
    """The load of `request.spec`.

    Raises
    ------
    GeometryError
        With the key, see `LoadSpec.course`.
    EffectError
        If the load acts on the far end of a linkage that the follower cannot move at some cam
        angle.
    """
    subject = request.subject
    is_torque = demand_unit(subject) == "rad"
    unit = "N m" if is_torque else "N"
    course = request.spec.course(subject.plan, unit)
    scale = N_MM if is_torque else 1.0
    refuse_locked(subject, " against its load")

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = np.zeros((4, len(phi)))
        out[0] = -scale * course.values(phi, side) * _way(subject, phi, side)
        return out

    def work(phi: FloatArray, side: Side) -> FloatArray:
        """Against a constant load, from the start of the stroke on."""
        found: FloatArray = scale * course.values(phi, side) * subject.plan.jet(phi, side)[0]
        return found

    potential = work if isinstance(course, Constant) else None
    edges = merged(np.concatenate((subject.smooth_angles, course.borders)))
    extremes = piecewise_extremes(course.values, edges)
    return Load(
        force=Force("load", coefficients, potential, course.borders),
        findings=(
            _extreme("largest", extremes.highest, unit),
            _extreme("smallest", extremes.lowest, unit),
        ),
        columns=(Column("load", unit, course.values, borders=course.borders),),
    )


def _way(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """ds/dq (n,): way of the demanded motion a unit of the follower's."""
    if subject.linkage is None:
        return np.ones(len(phi))
    return subject.linkage.per_follower(subject.plan.jet(phi, side)[0])


def _extreme(which: str, end: Extreme, unit: str) -> Finding:
    return Finding(
        name=f"{which}-load",
        severity="ok",
        sentence=(
            f"{which} load {end.value:.6g} {unit}, positive against a positive motion, at cam angle"
            f" {math.degrees(end.place):.6g} deg"
        ),
        value=end.value,
        unit=unit,
        cam_angle=math.fmod(end.place, TURN),
    )
