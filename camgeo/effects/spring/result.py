"""Effect `spring`: a linear spring, see `camgeo.effects.spring.ways` for its formulas."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.effects.effect import Column, Request, Subject, driving_slider
from camgeo.effects.force import Force, unmoved
from camgeo.effects.results import Spring
from camgeo.effects.spring.findings import deflection, force_findings, opening
from camgeo.effects.spring.spec import Spec
from camgeo.effects.spring.ways import (
    Way,
    about_pivot,
    along_guide,
    along_slider,
    between_points,
)
from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray

NEWTON_METRE: Final = 1e3
"""N mm, and N mm/rad."""


def compute(request: Request[Spec]) -> Spring:
    """The spring.

    Raises
    ------
    GeometryError
        With the key, if a spring of this kind does not fit the follower, or has no direction, or
        cannot close the contact all round by a slider.
    """
    subject, spec = request.subject, request.spec
    way = way_of(subject, spec)
    torsion = spec.kind == "torsion"
    preload, stiffness = spec.preload, spec.stiffness

    def magnitude(phi: FloatArray, side: Side) -> FloatArray:
        """F (n,) [N or N mm]."""
        return np.asarray(preload - stiffness * way(phi, side)[0])

    def on_follower(phi: FloatArray, side: Side) -> FloatArray:
        x, rate = way(phi, side)
        return (preload - stiffness * x) * rate

    def potential(phi: FloatArray, side: Side) -> FloatArray:
        x = way(phi, side)[0]
        return np.asarray((0.5 * stiffness * x - preload) * x)

    unit, scale = ("N m", NEWTON_METRE) if torsion else ("N", 1.0)

    def shown(phi: FloatArray, side: Side) -> FloatArray:
        return magnitude(phi, side) / scale

    return Spring(
        findings=(
            *force_findings(shown, subject, unit),
            deflection(way, subject, torsion=torsion),
            *opening(way, subject),
        ),
        columns=(Column("spring torque" if torsion else "spring force", unit, shown),),
        force=Force("spring", unmoved(on_follower), potential),
        way=way,
        preload=preload,
        stiffness=stiffness,
        unit_of_preload=unit,
        unit_of_stiffness="N m/rad" if torsion else "N/mm",
    )


def way_of(subject: Subject, spec: Spec) -> Way:
    """How the spring of `spec` relaxes; GeometryError as of `compute`."""
    pivot = subject.cam.follower.pivot
    if pivot is None:
        if spec.kind == "torsion":
            raise GeometryError(
                "a translating follower has no pivot for a torsion spring",
                key="effects.spring.kind",
                value="torsion",
            )
        if spec.anchor is not None:
            raise GeometryError(
                "is for rockers: the spring of a translating follower acts along its guide",
                key="effects.spring.anchor",
            )
        return along_guide(subject)
    if spec.kind == "torsion":
        return about_pivot(subject)
    if spec.anchor is not None and spec.attachment is not None:
        sense = 1.0 if spec.kind == "compression" else -1.0
        return between_points(subject, pivot, spec.anchor, spec.attachment, sense)
    linkage = driving_slider(subject)
    if linkage is None:
        raise GeometryError(
            "is missing: a spring on a rocker needs anchor and attachment, or is a torsion spring",
            key="effects.spring.anchor",
        )
    return along_slider(subject, linkage)
