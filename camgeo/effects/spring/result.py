"""Effect `spring`: a linear spring, see `camgeo.effects.spring.travel` for its formulas."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column, Request, Subject, driving_slider
from camgeo.effects.force import Force, unmoved
from camgeo.effects.results import Spring
from camgeo.effects.spring.table import SpringData
from camgeo.effects.spring.travel import (
    Travel,
    about_pivot,
    along_guide,
    along_slider,
    between_points,
    closing_sense,
    outward,
)
from camgeo.effects.wording import at, between, placed
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes, stretch_below
from camgeo.numeric.rounding import SHARE
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity

NEWTON_METRE: Final = 1e3
"""From N m to N mm, and from N m/rad to N mm/rad."""


def compute(request: Request[SpringData]) -> Spring:
    """The spring.

    Raises
    ------
    GeometryError
        With the key, if a spring of this kind does not fit the follower, has no direction, or
        cannot close the contact over the whole turn by a slider.
    """
    subject, data = request.subject, request.data
    way = travel_of(subject, data)
    torsion = data.kind == "torsion"
    preload, stiffness = data.preload, data.stiffness

    def magnitude(phi: FloatArray, side: Side) -> FloatArray:
        """F (n,) [N or N mm]."""
        return np.asarray(preload - stiffness * way(phi, side)[0])

    def on_follower(phi: FloatArray, side: Side) -> FloatArray:
        x, rate = way(phi, side)
        return (preload - stiffness * x) * rate

    def potential(phi: FloatArray, side: Side) -> FloatArray:
        x = way(phi, side)[0]
        return np.asarray((0.5 * stiffness * x - preload) * x)

    far = subject.drive.far_end

    def off(phi: FloatArray, q: FloatArray, _rate: FloatArray) -> FloatArray:
        x, rate = way.at(far.place(phi, q) if far is not None and way.per_stroke else q)
        return (preload - stiffness * x) * rate

    def on_slider(phi: FloatArray, side: Side) -> FloatArray:
        return way.per_stroke * magnitude(phi, side)

    unit, scale = ("N m", NEWTON_METRE) if torsion else ("N", 1.0)

    def shown(phi: FloatArray, side: Side) -> FloatArray:
        return magnitude(phi, side) / scale

    found = piecewise_extremes(shown, subject.state.smooth_angles)
    wound = None
    if data.helical is not None:
        from camgeo.effects.spring.coils import of_wire  # few springs are stated so

        wound = of_wire(data.helical, magnitude, found)
    return Spring(
        findings=(
            *force_findings(shown, found, subject, unit),
            deflection(way, subject, torsion=torsion),
            *opening(way, subject),
            *(() if wound is None else wound.findings),
        ),
        columns=(
            Column("spring torque" if torsion else "spring force", unit, shown),
            *(() if wound is None else wound.columns),
        ),
        force=Force(
            "spring",
            unmoved(on_follower),
            potential,
            off=off,
            far=unmoved(on_slider) if way.per_stroke else None,
        ),
        way=way,
        preload=preload,
        stiffness=stiffness,
        unit_of_preload=unit,
        unit_of_stiffness="N m/rad" if torsion else "N/mm",
        helical=data.helical,
        line=way.line,
        per_stroke=way.per_stroke,
    )


def travel_of(subject: Subject, data: SpringData) -> Travel:
    """The travel of the spring in `data`; raises GeometryError as `compute` does."""
    pivot = subject.cam.follower.pivot
    if pivot is None:
        if data.kind == "torsion":
            raise GeometryError(
                "a translating follower has no pivot for a torsion spring",
                key="effects.spring.kind",
                value="torsion",
            )
        if data.anchor is not None:
            raise GeometryError(
                "is for rockers: the spring of a translating follower acts along its guide",
                key="effects.spring.anchor",
            )
        return along_guide(subject)
    if data.kind == "torsion":
        return about_pivot(subject)
    if data.anchor is not None and data.attachment is not None:
        sense = 1.0 if data.kind == "compression" else -1.0
        return between_points(subject, pivot, data.anchor, data.attachment, sense)
    linkage = driving_slider(subject)
    if linkage is None:
        raise GeometryError(
            "is missing: a spring on a rocker needs anchor and attachment, or kind torsion",
            key="effects.spring.anchor",
        )
    return along_slider(subject, linkage)


def force_findings(force: Quantity, found: Extremes, subject: Subject, unit: str) -> list[Finding]:
    """Largest and smallest force [`unit`], `found`, and where it is below 0."""
    name = "torque" if unit == "N m" else "force"
    findings = [
        placed(
            f"{size}-spring-{name}",
            f"{size} spring {name} {extreme.value:.6g} {unit} {at(extreme.place)}",
            extreme,
            unit,
        )
        for size, extreme in (("largest", found.highest), ("smallest", found.lowest))
    ]
    lowest = found.lowest
    if lowest.value < -SHARE * found.magnitude:
        slack = _below(force, subject.state.smooth_angles, lowest.place)
        findings.append(
            Finding(
                name="slack-spring",
                severity="warning",
                sentence=(
                    f"the spring {name} is below 0 {between(slack)}, {lowest.value:.6g} {unit}"
                    f" {at(lowest.place)}: a real spring would be slack there, but the values"
                    " follow the formula"
                ),
                value=lowest.value,
                limit=0.0,
                unit=unit,
                cam_angle=lowest.place,
                cam_range=slack,
            )
        )
    return findings


def deflection(way: Travel, subject: Subject, *, torsion: bool) -> Finding:
    """Largest change of length, or of angle, since cam angle 0."""
    found = piecewise_extremes(lambda phi, side: way(phi, side)[0], subject.state.smooth_angles)
    farthest = max(found.highest, found.lowest, key=lambda extreme: abs(extreme.value))
    value = abs(math.degrees(farthest.value) if torsion else farthest.value)
    unit = "deg" if torsion else "mm"
    kind = "relaxed" if farthest.value > 0.0 else "tightened"
    place = farthest.place
    sentence = f"largest spring deflection {value:.6g} {unit} {at(place)}, {kind} since cam angle 0"
    return placed("largest-spring-deflection", sentence, Extreme(value, place), unit)


def opening(way: Travel, subject: Subject) -> list[Finding]:
    """A warning where the spring presses away from the flank in use."""
    edges = subject.state.smooth_angles

    def closing(phi: FloatArray, side: Side) -> FloatArray:
        """With the sign of dx/dn towards the flank."""
        towards = closing_sense(subject) * outward(subject, phi, side)
        return np.asarray(towards * way(phi, side)[1])

    found = piecewise_extremes(closing, edges)
    if found.lowest.value >= -SHARE * found.magnitude:
        return []
    away = _below(closing, edges, found.lowest.place)
    return [
        Finding(
            name="spring-opens-contact",
            severity="warning",
            sentence=(
                f"the spring presses the {subject.cam.follower.touching} away from its flank"
                f" {between(away)}"
            ),
            cam_angle=found.lowest.place,
            cam_range=away,
        )
    ]


def _below(function: Quantity, edges: FloatArray, place: float) -> tuple[float, float]:
    """The range (from, to) [rad] around `place` in which `function` is below 0."""
    found = stretch_below(lambda phi: function(phi, "right"), edges, place)
    return found or (place % TURN, place % TURN)
