"""Effect `contact-pressure`: Hertzian pressure between cam and follower, stresses and life.

It needs the normal force, the curvature of roller and flank (a flat face has none) and their
materials. See `hertz` for the formulas of the contact, `contact` for its curvature and `life` for
the roller bearing. Friction between roller and flank adds little to the stresses of a rolling
contact and is neglected.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.effects.contact_pressure.findings import HOUR, Worst, life_findings, pressure_findings
from camgeo.effects.contact_pressure.life import EXPONENTS, Life, rolling_life
from camgeo.effects.contact_pressure.line_contact import SHEAR_SHARE, LineContact
from camgeo.effects.contact_pressure.table import PressureRequirements
from camgeo.effects.effect import SPEED, Bound, Column, Quantity, Request, Result, Subject
from camgeo.effects.results import CONTACT_FORCE
from camgeo.effects.touching import FLANKS, OUTER, sides_of, with_other_side
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, piecewise_highest
from camgeo.units import RPM, TURN

KEY: Final = "effects.contact-pressure"


@dataclass(frozen=True, slots=True, eq=False)
class ContactPressure(Result):
    """The contact pressure.

    Attributes
    ----------
    findings, columns, errors : see `camgeo.effects.effect.Result`; the pressure is exact, the life
        is integrated.
    contact : force, relative curvature and pressure over the cam angle.
    largest : the largest pressure [MPa] and its cam angle [rad] in [0, 2 pi).
    life : of the roller bearing; None if the scene gives no rating.
    returning : the same for the return disc of a conjugate pair, or the opposite side of a yoke;
        None without one.
    """

    contact: LineContact
    largest: Extreme
    life: Life | None
    returning: ContactPressure | None = None


def compute(request: Request[PressureRequirements]) -> ContactPressure:
    """The pressure at the speed of the scene.

    Raises
    ------
    GeometryError
        If the follower has a knife edge, the width of the contact is missing or larger than that of
        the part, or a life is requested and the scene gives no speed.
    EffectError
        If a cusp or undercut is loaded, or the life does not reach the tolerance.
    """
    force = request.results[CONTACT_FORCE]
    subject = request.subject
    main = _of_disc(request, subject, force.normal, force.edges)
    if subject.returning is None:
        return main

    def on_return(phi: FloatArray, side: Side) -> FloatArray:
        return -force.normal(phi, side)

    names, noun = sides_of(subject)
    words = f"{names[OUTER]} {noun}"
    other = _of_return(request, subject.returning, on_return, force.edges, words)
    return replace(with_other_side(subject, main, other), returning=other)


def _of_disc(
    request: Request[PressureRequirements], subject: Subject, normal: Quantity, edges: FloatArray
) -> ContactPressure:
    """The pressure on one disc, `subject`; `edges` are those of the force `normal`."""
    data = request.data
    if subject.cam.follower.has_edge:
        raise GeometryError(
            "is 0, a knife edge: contact pressure needs a roller or a flat face",
            key="follower.roller_radius",
            value="0",
        )
    contact = LineContact(subject, normal, data.modulus, _width(subject, data))
    edges = merged(np.concatenate((subject.state.smooth_angles, edges)))
    contact.refuse_cusps(edges)
    highest = piecewise_highest(contact.square, edges)
    worst = _worst(contact, highest.place, highest.value)
    life = None
    if data.rating is not None:
        if subject.state.course is None:
            raise GeometryError(
                f"is missing: the life of the roller bearing needs {SPEED[0]} or {SPEED[1]}",
                key=SPEED[0],
            )
        exponent = EXPONENTS[data.bearing]
        life = rolling_life(
            contact, edges, request.course, data.rating, exponent, request.tolerance
        )

    def shear(phi: FloatArray, side: Side) -> FloatArray:
        return SHEAR_SHARE * contact.pressure(phi, side)

    inside = edges[(edges > 0.0) & (edges < TURN)]
    return ContactPressure(
        findings=(
            *pressure_findings(worst, data),
            *(() if life is None else life_findings(life, data)),
        ),
        columns=(
            Column("contact pressure", "MPa", contact.pressure, data.limit, inside),
            Column("subsurface shear", "MPa", shear, None, inside),
        ),
        errors={} if life is None else errors_of(life),
        contact=contact,
        largest=Extreme(worst.pressure(data.modulus), worst.angle),
        life=life,
    )


def errors_of(life: Life) -> dict[str, Bound]:
    """The errors of what is integrated; all else is exact."""
    found = {"roller-speed": _relative(life.speed / RPM, life.speed_error)}
    if life.seconds is not None:
        found["roller-life"] = _relative(life.seconds / HOUR, life.error)
        found["equivalent-roller-load"] = _relative(life.load, life.load_error)
    return found


def _relative(value: float, error: float) -> Bound:
    return Bound(error * value, value)


def _of_return(
    request: Request[PressureRequirements],
    subject: Subject,
    normal: Quantity,
    edges: FloatArray,
    words: str,
) -> ContactPressure:
    """As `_of_disc`; its error message names the return disc, or the side, by these `words`."""
    try:
        return _of_disc(request, subject, normal, edges)
    except EffectError as error:
        raise replace(error, message=f"{words}: {error.message}") from error


def _width(subject: Subject, data: PressureRequirements) -> float:
    """L [mm]."""
    part = subject.part_spec
    groove = subject.cam.contact.closed_by_form
    whole = None if part is None else part.groove_depth if groove else part.thickness
    name = "groove_depth" if groove else "thickness"
    if data.width is None:
        if whole is None:
            raise GeometryError(
                f"is missing, and so is {name} of [part], which is its default",
                key=f"{KEY}.width",
            )
        return whole
    if whole is not None and data.width > whole:
        raise GeometryError(
            f"the contact cannot be wider than the flank: {name} of [part] is {whole:g} mm",
            key=f"{KEY}.width",
            value=f"{data.width:g}",
        )
    return data.width


def _worst(contact: LineContact, angle: float, square: float) -> Worst:
    """The contact at `angle` [rad], from the side on which p^2 is `square`."""
    phi = np.array([angle])
    sides: tuple[Side, ...] = ("right", "left")
    side = min(sides, key=lambda each: abs(float(contact.square(phi, each)[0]) - square))
    load, radius = contact.load_and_radius(phi, side)
    sense = int(contact.carried(phi, side)[1][0])
    follower = contact.subject.cam.follower
    # Of the path of the centre of a roller with clearance, offset by half the clearance.
    bend = sense * float(contact.curvature(phi, side)[0])
    bend /= 1.0 - 0.5 * contact.subject.cam.clearance * bend
    return Worst(
        angle=angle % TURN,
        flank=FLANKS[sense],
        load=float(load[0]),
        radius=float(radius[0]),
        curvature=bend,
        roller=follower.roller_radius or None,
        width=contact.width,
    )
