"""The load as a force on the follower."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import (
    SLIDER_ONLY,
    Column,
    Request,
    Subject,
    demand_unit,
    driving_slider,
)
from camgeo.effects.force import Force
from camgeo.effects.load.course import Constant
from camgeo.errors import EffectError, GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extreme
from camgeo.numeric.peaks import piecewise_extremes
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.mechanism.slider_crank import SliderCrank

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
        With the key, see `LoadSpec.course`, or if the far end of the linkage is no slider.
    EffectError
        If the load acts on the slider of a linkage that the rocker cannot move at some cam angle.
    """
    subject = request.subject
    slider = driving_slider(subject)
    if subject.linkage is not None and slider is None:
        raise GeometryError(SLIDER_ONLY, key="effects.load")
    is_torque = demand_unit(subject) == "rad"
    unit = "N m" if is_torque else "N"
    course = request.spec.course(subject.plan, unit)
    scale = N_MM if is_torque else 1.0
    _refuse_locked(subject, slider)

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = np.zeros((4, len(phi)))
        out[0] = -scale * course.values(phi, side) * _slide(subject, slider, phi, side)
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


def _slide(subject: Subject, slider: SliderCrank | None, phi: FloatArray, side: Side) -> FloatArray:
    """ds/dq (n,): way of the demanded motion a unit of the follower's."""
    if slider is None:
        return np.ones(len(phi))
    slide: FloatArray = slider.per_swing(subject.plan.jet(phi, side)[0])[0]
    return slide


def _refuse_locked(subject: Subject, slider: SliderCrank | None) -> None:
    locked = None if slider is None else slider.locked_at(subject.plan)
    if locked is not None:
        phi, stroke = locked
        raise EffectError(
            "the coupler stands across the guide of the slider at cam angle"
            f" {math.degrees(phi):.6g} deg, stroke {stroke:.6g} mm: the rocker cannot move the"
            " slider against its load there, at whatever force; the stroke must keep clear of it",
            finding="locked-slider",
            value=stroke,
            unit="mm",
            cam_angle=phi,
        )


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
