"""Effect `friction`: Coulomb, rolling and viscous friction, and the margin against jamming."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.effect import Request, Subject, driving_slider
from camgeo.effects.force import Coefficients, Force, Off
from camgeo.effects.friction.jamming import column, jamming_margin
from camgeo.effects.friction.statics import Statics, senses_of
from camgeo.effects.friction.table import FrictionCoefficients
from camgeo.effects.results import Friction
from camgeo.effects.touching import INNER, OUTER, require_convex
from camgeo.effects.wording import at
from camgeo.errors import EffectError, GeometryError
from camgeo.mechanism.positions import locked_at
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import grid_of
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.mechanism.slider_crank import SliderCrank


def compute(request: Request[FrictionCoefficients]) -> Friction:
    """The friction of the follower.

    Raises
    ------
    GeometryError
        With the key, if the scene names a part that the follower does not have.
    EffectError
        If the rocker cannot move a slider with friction, the pitch curve has a cusp, or the cam for
        a flat face is not convex.
    """
    subject, data = request.subject, request.data
    require_convex(subject, "friction of the face")
    edges = subject.state.smooth_angles
    statics = statics_of(subject, data)
    try:
        borders = _borders(statics, edges)
        findings = jamming_margin(statics, merged(np.concatenate((edges, borders))))
    except GeometryError as error:
        raise EffectError(
            f"there is no friction of the {subject.cam.follower.touching}: {error.message}"
        ) from error
    return Friction(
        findings=findings,
        columns=(column(statics, borders),),
        force=_force(subject, data, borders),
        per_normal=statics.per_normal,
        at_contact=statics.at_contact,
        bearing=statics.bearing,
        guide_length=data.guide_length,
        on_roller=(0.5 * data.roller_pin * data.roller_pin_diameter, data.rolling),
        rubbing=statics.rubbing,
    )


def statics_of(subject: Subject, data: FrictionCoefficients) -> Statics:
    """The friction that grows with the normal force."""
    motion = subject.state.motion
    senses = senses_of(motion, subject.state.smooth_angles)
    start = float(subject.drive.motion.jet(np.zeros(1), "right", 1)[0, 0])
    return Statics(subject, data, senses, start)


def _borders(statics: Statics, edges: FloatArray) -> FloatArray:
    """Where an angular velocity, a reaction or a direction changes sign on either flank."""
    found = [edges]
    if statics.data.face and statics.swing:
        found.append(roots_on_grid(lambda phi: statics.state(phi, "right", 1).slip, grid_of(edges)))
    for sense in (INNER, OUTER):

        def spin(phi: FloatArray, sense: int = sense) -> FloatArray:
            return statics.state(phi, "right", sense).spin

        if statics.data.roller_pin:
            found.append(roots_on_grid(spin, grid_of(edges)))
        cuts = merged(np.concatenate(found))
        for name in ("sine", "cosine", *(() if statics.swing else ("near", "far"))):

            def signed(phi: FloatArray, sense: int = sense, name: str = name) -> FloatArray:
                values: FloatArray = getattr(statics.state(phi, "right", sense), name)
                return values

            found.append(roots_on_grid(signed, grid_of(cuts)))
    return np.mod(merged(np.concatenate(found[1:])), TURN)


def _force(subject: Subject, data: FrictionCoefficients, borders: FloatArray) -> Force:
    """The friction that does not depend on the normal force.

    Viscous: Q = -c ds/dt ds/dq along the guide, which is -c dq/dt for the follower itself; Coulomb
    friction of a slider: Q = -F sign(ds/dt) ds/dq, by virtual work.
    """
    linkage = driving_slider(subject)
    if linkage is not None and (data.slider or data.guide_viscous):
        far = _on_slider(subject, data, linkage)

        def coefficients(phi: FloatArray, side: Side) -> FloatArray:
            found = far(phi, side) * linkage.per_follower(subject.state.output.jet(phi, side)[0])
            if data.pivot_viscous:
                found[1] -= data.pivot_viscous * subject.state.motion.jet(phi, side, 1)[1]
            return np.asarray(found)

        return Force("friction", coefficients, borders=borders, off=_off(subject, data), far=far)
    viscous = data.pivot_viscous + data.guide_viscous  # a follower has only one of the two

    def own(phi: FloatArray, side: Side) -> FloatArray:
        out = np.zeros((4, len(phi)))
        if viscous:
            out[1] = -viscous * subject.state.motion.jet(phi, side, 1)[1]
        return out

    return Force("friction", own, borders=borders, off=_off(subject, data))


def _off(subject: Subject, data: FrictionCoefficients) -> Off:
    """The same on a follower that is off the cam."""
    far = subject.drive.far_end
    if far is None or driving_slider(subject) is None:
        viscous = data.pivot_viscous + data.guide_viscous
        return lambda _phi, _q, rate: -viscous * rate

    def off(phi: FloatArray, q: FloatArray, rate: FloatArray) -> FloatArray:
        slide = far.jet(phi, q)[1]
        pace = slide * rate
        found = -(data.slider * np.sign(pace) + data.guide_viscous * pace) * slide
        return np.asarray(found - data.pivot_viscous * rate)

    return off


def _on_slider(subject: Subject, data: FrictionCoefficients, linkage: SliderCrank) -> Coefficients:
    """Coefficients of the friction along the stroke; EffectError where the slider is locked."""
    output = subject.state.output
    locked = locked_at(linkage, output)
    if locked is not None:
        raise EffectError(
            f"the rocker cannot move the slider against its friction: {at(locked[0])}, stroke"
            f" {locked[1]:.6g} mm, the coupler is square to the guide",
            cam_angle=locked[0] % TURN,
        )
    strokes = senses_of(output, subject.state.smooth_angles)

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = np.zeros((4, len(phi)))
        out[0] = -data.slider * strokes(phi, side)
        out[1] = -data.guide_viscous * output.jet(phi, side, 1)[1]
        return out

    return coefficients
