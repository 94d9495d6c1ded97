"""Gravity: the weights of the masses as a force on the follower.

A weight m g does the work m g.dx when its centre of mass moves by dx, so its generalised force is
Q = m g.(dx/dq), by virtual work. The axes are those of the drawing of the cam at cam angle 0, with
x to the right and y up; the frame does not turn.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Column, Request, scaled
from camgeo.dynamics.effects.forces import Force, unmoved
from camgeo.dynamics.effects.results import INERTIA, Gravity
from camgeo.dynamics.effects.wording import FORCES, extreme_findings
from camgeo.numeric.arrays import SHARE, ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes

STANDARD_GRAVITY: Final = 9806.65
"""g_n [mm/s^2] (3rd CGPM 1901, resolution on the standard value of the acceleration of gravity;
ISO 80000-3, acceleration of free fall)."""

DOWNWARDS: Final = -0.5 * math.pi
"""Direction of gravity [rad] by default, counter-clockwise from the x axis."""


def compute(request: Request[Mapping[str, Any]]) -> Gravity:
    """The weights of the masses of ``[effects.inertia]``: c0 alone."""
    masses = request.results[INERTIA].masses
    pull = STANDARD_GRAVITY * cmath.rect(1.0, request.data.get("angle", DOWNWARDS))
    subject = request.subject

    def on_follower(phi: FloatArray, side: Side) -> FloatArray:
        force = np.zeros(len(phi))
        for mass in masses:
            force += mass.mass * _along(mass.per_lift(phi, side), pull)
        return force

    def free_force(phi: FloatArray, q: FloatArray, _rate: FloatArray) -> FloatArray:
        force = np.zeros(len(q))
        for mass in masses:
            force += mass.mass * _along(mass.per_coordinate(phi, q), pull)
        return force

    label = FORCES[subject.cam.lift_unit]
    acting = scaled(on_follower, label.scale)
    weight = STANDARD_GRAVITY * sum(mass.mass for mass in masses)
    extremes = piecewise_extremes(acting, subject.state.smooth_angles)
    return Gravity(
        force=Force("gravity", unmoved(on_follower), free_force=free_force),
        findings=(
            Finding("weight", "ok", f"weight of all masses {weight:.6g} N", weight, unit="N"),
            *extreme_findings(
                "weight-force",
                f"{label.word} of the weights on the follower",
                extremes,
                label.unit,
                ", positive in the direction of increasing lift",
            ),
        ),
        columns=(Column(f"weight {label.word}", label.unit, acting),),
        pull=pull,
    )


def _along(vectors: ComplexArray, pull: complex) -> FloatArray:
    """(n,) scalar products, 0 where the vectors are perpendicular except for rounding."""
    product: FloatArray = vectors.real * pull.real + vectors.imag * pull.imag
    return np.where(np.abs(product) <= SHARE * abs(pull) * np.abs(vectors), 0.0, product)
