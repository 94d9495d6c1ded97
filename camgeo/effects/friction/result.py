"""Effect `friction`: Coulomb's, rolling and viscous friction, and the margin to jamming."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.carrier import INNER, OUTER
from camgeo.effects.effect import Request, Result, Subject, driving_slider, toucher
from camgeo.effects.face import require_convex
from camgeo.effects.force import Coefficients, Force
from camgeo.effects.friction.jamming import column, jamming_margin
from camgeo.effects.friction.senses import senses_of
from camgeo.effects.friction.spec import Spec
from camgeo.effects.friction.statics import Statics
from camgeo.effects.results import Friction as Asked
from camgeo.errors import EffectError, GeometryError
from camgeo.mechanism.positions import locked_at
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.peaks import grid_of
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.effects.friction.senses import Senses
    from camgeo.mechanism.slider_crank import SliderCrank


@dataclass(frozen=True, slots=True, eq=False)
class Friction(Result):
    """Friction of the follower.

    Attributes
    ----------
    force : what does not depend on the normal force: viscous friction, and that of a slider.
    statics : what does.
    borders : (k,) cam angles [rad] in [0, 2 pi), besides those of the motion, where `per_normal`
        has a kink or jump.
    """

    force: Force
    statics: Statics
    borders: FloatArray

    def per_normal(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(2, n) what friction adds per unit of |N| on the side `sense`, see `carrier`.

        [0] generalised force on q [1 or mm/rad]; [1] torque on the cam [mm], that is N mm per N,
        positive where the cam has to be driven more. Coulomb's friction of guide and pivot is in
        [0] alone, and none in a rest; the roller turns, and a face slides, in a rest too.
        GeometryError at a cusp.
        """
        return self.statics.per_normal(phi, side, sense)


def compute(request: Request[Spec]) -> Asked:
    """Friction.

    Raises
    ------
    GeometryError
        With the key, if a part of the follower is named that it does not have.
    EffectError
        If a slider with friction cannot be moved by the rocker; if the pitch curve has a cusp, or
        the cam for a flat face is not convex.
    """
    subject, spec = request.subject, request.spec
    require_convex(subject, "friction of the face")
    edges = subject.cam.drive.smooth_angles
    senses = senses_of(subject.cam.drive.motion, edges)
    start = float(subject.cam.drive.motion.jet(np.zeros(1), "right", 1)[0, 0])
    back = subject.returning
    other = None if back is None else Statics(back, spec, senses, start)
    statics = Statics(subject, spec, senses, start, other)
    try:
        borders = _borders(statics, edges)
        findings = jamming_margin(statics, merged(np.concatenate((edges, borders))))
    except GeometryError as error:
        raise EffectError(
            f"there is no friction of the {toucher(subject)}: {error.message}"
        ) from error
    return Friction(
        findings=findings,
        columns=(column(statics, borders),),
        force=Force("friction", _coefficients(subject, spec, senses), borders=borders),
        statics=statics,
        borders=borders,
    )


def _borders(statics: Statics, edges: FloatArray) -> FloatArray:
    """Where, on either flank, an angular velocity, a reaction or a side changes its sign."""
    found = [edges]
    if statics.spec.face and statics.swing:
        found.append(roots_on_grid(lambda phi: statics.state(phi, "right", 1).slip, grid_of(edges)))
    for sense in (INNER, OUTER):

        def spin(phi: FloatArray, sense: int = sense) -> FloatArray:
            return statics.state(phi, "right", sense).spin

        if statics.spec.roller_pin:
            found.append(roots_on_grid(spin, grid_of(edges)))
        cuts = merged(np.concatenate(found))
        for name in ("sine", "cosine", *(() if statics.swing else ("near", "far"))):

            def signed(phi: FloatArray, sense: int = sense, name: str = name) -> FloatArray:
                values: FloatArray = getattr(statics.state(phi, "right", sense), name)
                return values

            found.append(roots_on_grid(signed, grid_of(cuts)))
    return np.mod(merged(np.concatenate(found[1:])), TURN)


def _coefficients(subject: Subject, spec: Spec, senses: Senses) -> Coefficients:
    """Of the friction that the normal force has no part in.

    Viscous: Q = -c ds/dt ds/dq along the guide, with dq/dt alone for the follower's own; Coulomb's
    of a slider: Q = -F sign(ds/dt) ds/dq, by virtual work.
    """
    linkage = driving_slider(subject)
    if linkage is not None and (spec.slider or spec.guide_viscous):
        return _of_slider(subject, spec, linkage, senses.edges)
    viscous = spec.pivot_viscous + spec.guide_viscous  # a follower has one of the two

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = np.zeros((4, len(phi)))
        if viscous:
            out[1] = -viscous * subject.cam.drive.motion.jet(phi, side, 1)[1]
        return out

    return coefficients


def _of_slider(
    subject: Subject, spec: Spec, linkage: SliderCrank, edges: FloatArray
) -> Coefficients:
    """Of slider and pivot."""
    plan = subject.cam.drive.plan
    locked = locked_at(linkage, plan)
    if locked is not None:
        raise EffectError(
            "the rocker cannot move the slider against its friction: at cam angle"
            f" {math.degrees(locked[0]):.4f} deg, stroke {locked[1]:.6g} mm, the coupler stands"
            " across the guide",
            cam_angle=locked[0] % TURN,
        )
    strokes = senses_of(plan, edges)

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        stroke = plan.jet(phi, side, 1)
        slide = linkage.per_follower(stroke[0])
        out = np.zeros((4, len(phi)))
        out[0] = -spec.slider * strokes(phi, side) * slide
        out[1] = -spec.guide_viscous * stroke[1] * slide
        if spec.pivot_viscous:
            out[1] -= spec.pivot_viscous * subject.cam.drive.motion.jet(phi, side, 1)[1]
        return out

    return coefficients
