"""Effect `contact-pressure`: Hertzian pressure between cam and follower, stresses and life.

It needs the normal force, the curvature of roller and flank (a flat face has none) and their
materials; see "line contact" below, and "life" for the roller bearing. Friction between roller and
flank adds little to the stresses of a rolling contact and is neglected.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, NoReturn

import numpy as np

from camgeo.check.finding import Finding, limit_finding
from camgeo.dynamics.effects.contact import FLANKS, INNER, OUTER, side_names, with_other_side
from camgeo.dynamics.effects.effect import (
    SPEED,
    Bound,
    Column,
    Quantity,
    Request,
    Result,
    Subject,
    scaled,
)
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.dynamics.effects.tables import PressureRequirements
from camgeo.dynamics.effects.wording import at_angle, placed, tolerance_error
from camgeo.dynamics.state.state import Model
from camgeo.errors import EffectError, GeometryError
from camgeo.kinematics.time_course import TimeCourse, period
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import (
    Extreme,
    piecewise_highest,
    piecewise_lowest,
    with_roots,
)
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import RPM, TURN

KEY: Final = "effects.contact-pressure"


@dataclass(frozen=True, slots=True, eq=False)
class ContactPressure(Result):
    """The contact pressure.

    Attributes
    ----------
    findings, columns, errors : see `camgeo.dynamics.effects.effect.Result`; the pressure is exact,
    the life
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
    main = _disc_pressure(request, subject, force.normal, force.edges)
    if subject.returning is None:
        return main
    try:
        other = _disc_pressure(request, subject.returning, scaled(force.normal, -1.0), force.edges)
    except EffectError as error:  # of the return disc, or of the opposite side
        names, noun = side_names(subject)
        raise replace(error, message=f"{names[OUTER]} {noun}: {error.message}") from error
    return replace(with_other_side(subject, main, other), returning=other)


def _disc_pressure(
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
    inside = edges[(edges > 0.0) & (edges < TURN)]
    return ContactPressure(
        findings=(
            *pressure_findings(worst, data),
            *(() if life is None else life_findings(life, data)),
        ),
        columns=(
            Column("contact pressure", "MPa", contact.pressure, data.limit, inside),
            Column("subsurface shear", "MPa", scaled(contact.pressure, SHEAR_SHARE), None, inside),
        ),
        errors={} if life is None else figure_errors(life),
        contact=contact,
        largest=Extreme(worst.pressure(data.modulus), worst.angle),
        life=life,
    )


def figure_errors(life: Life) -> dict[str, Bound]:
    """The errors of what is integrated; all else is exact."""
    errors = {"roller-speed": _relative(life.speed / RPM, life.speed_error)}
    if life.seconds is not None:
        errors["roller-life"] = _relative(life.seconds / HOUR, life.error)
        errors["equivalent-roller-load"] = _relative(life.load, life.load_error)
    return errors


def _relative(value: float, error: float) -> Bound:
    return Bound(error * value, value)


def _width(subject: Subject, data: PressureRequirements) -> float:
    """L [mm]."""
    part = subject.part_spec
    groove = subject.cam.contact.closed_by_form
    # The flanks of a groove are as wide as it is deep.
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
    # Where the pressure jumps, only one side has the value that the search has found.
    side = min(sides, key=lambda side: abs(float(contact.square(phi, side)[0]) - square))
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


# -- findings -------------------------------------------------------------------------------------
# Findings of the contact pressure.


HOUR: Final = 3600.0

LONGEST: Final = 1e6
"""A life [h] of more than a century is not stated in figures: no bearing ends by fatigue
alone then, and the formula knows nothing else."""

HEAVY: Final = 0.5
"""Share of the dynamic load rating up to which the life formula applies (ISO 281:2007)."""


@dataclass(frozen=True, slots=True)
class Worst:
    """The contact where the pressure is largest.

    Attributes
    ----------
    angle : cam angle [rad] in [0, 2 pi).
    flank : "inner" or "outer".
    load : force on the follower [N]; 0 if there is never any.
    radius : R, of the relative curvature [mm].
    curvature : of the pitch curve, positive if convex towards the follower [1/mm].
    roller : r_R [mm]; None with a flat face.
    width : L [mm].
    """

    angle: float
    flank: str
    load: float
    radius: float
    curvature: float
    roller: float | None
    width: float

    @property
    def place(self) -> str:
        """The place in words."""
        return at_angle(self.angle)

    def pressure(self, modulus: float) -> float:
        """p [MPa] for E* `modulus` [MPa]; 0 without force, whatever the radius."""
        if not self.load > 0.0:
            return 0.0
        return largest_pressure(self.load / self.width, modulus, self.radius)


def pressure_findings(worst: Worst, data: PressureRequirements) -> tuple[Finding, ...]:
    """Pressure, safety, subsurface shear and half width; needed width and roller radius."""
    pressure = worst.pressure(data.modulus)
    if not pressure > 0.0:
        return (
            Finding(
                name="largest-contact-pressure",
                severity="ok",
                sentence=(
                    f"nothing presses the {'roller' if worst.roller else 'face'} on its flank:"
                    " there is no contact pressure"
                ),
                value=0.0,
                limit=data.limit,
                unit="MPa",
            ),
        )
    safety = data.limit / pressure
    beyond = pressure > data.limit
    shear = SHEAR_SHARE * pressure
    width = half_width(worst.load / worst.width, data.modulus, worst.radius)
    depth = SHEAR_DEPTH * width
    return (
        placed(
            "largest-contact-pressure",
            f"largest contact pressure {pressure:.6g} MPa on the {worst.flank} flank {worst.place},"
            f" {'above' if beyond else 'at most'} {data.limit:g} MPa; the force is"
            f" {worst.load:.6g} N, the radius of relative curvature {worst.radius:.6g} mm",
            Extreme(pressure, worst.angle),
            "MPa",
            data.limit,
            "broken" if beyond else "ok",
        ),
        limit_finding(
            "pressure-safety",
            f"smallest safety against a contact pressure of {data.limit:g} MPa is {safety:.4f}"
            f" {worst.place}",
            safety,
            data.safety,
            cam_angle=worst.angle,
            least=True,
        ),
        placed(
            "largest-subsurface-shear",
            f"largest shear below the surface {shear:.6g} MPa {worst.place}, {depth:.6g} mm deep",
            Extreme(shear, worst.angle),
            "MPa",
        ),
        placed(
            "subsurface-shear-depth",
            f"depth of the largest shear {depth:.6g} mm {worst.place}",
            Extreme(depth, worst.angle),
            "mm",
        ),
        placed(
            "contact-half-width",
            f"half width of the contact {width:.6g} mm {worst.place}",
            Extreme(width, worst.angle),
            "mm",
        ),
        _needed_width(worst, pressure, data),
        _needed_radius(worst, data)
        if worst.roller is None
        else _needed_roller(worst, worst.roller, data),
    )


def _needed_width(worst: Worst, pressure: float, data: PressureRequirements) -> Finding:
    needed = worst.width * (pressure / data.allowed) ** 2
    sentence = (
        f"contact width needed for {data.allowed:.6g} MPa {worst.place}: {needed:.6g}"
        f" mm; it is {worst.width:g} mm"
    )
    return placed("needed-width", sentence, Extreme(needed, worst.angle), "mm")


def _needed_radius(worst: Worst, data: PressureRequirements) -> Finding:
    """The radius of curvature of the cam at which a flat face has the allowed pressure."""
    needed = needed_radius(worst.load / worst.width, data.modulus, data.allowed)
    sentence = (
        f"radius of curvature of the cam needed for {data.allowed:.6g} MPa {worst.place}:"
        f" {needed:.6g} mm; it is {worst.radius:.6g} mm"
    )
    return placed("needed-radius-of-curvature", sentence, Extreme(needed, worst.angle), "mm")


def _needed_roller(worst: Worst, roller: float, data: PressureRequirements) -> Finding:
    """The roller radius for the allowed pressure, with the same pitch curve and force."""
    name, load = "needed-roller-radius", worst.load / worst.width
    radii = roller_radii(needed_radius(load, data.modulus, data.allowed), worst.curvature)
    goal = f"for {data.allowed:.6g} MPa {worst.place} with the same pitch curve"
    if radii is None:
        best = 0.5 / worst.curvature
        least = largest_pressure(load, data.modulus, 0.5 * best)
        return Finding(
            name=name,
            severity="warning",
            sentence=(
                f"no roller radius is sufficient {goal}: {best:.6g} mm gives the smallest pressure,"
                f" {least:.6g} MPa"
            ),
            cam_angle=worst.angle,
        )
    low, high = radii
    # The end of the range that is nearer to the roller of the scene.
    nearest = high if roller > high else low
    upper = "or more" if math.isinf(high) else f"to {high:.6g} mm"
    sentence = f"roller radius needed {goal}: {low:.6g} mm {upper}; it is {roller:g} mm"
    return placed(name, sentence, Extreme(nearest, worst.angle), "mm")


def life_findings(life: Life, data: PressureRequirements) -> tuple[Finding, ...]:
    """Life of the roller bearing, its equivalent load, and the speed of the roller."""
    assert data.rating is not None  # else there is no life
    speed = life.speed / RPM
    turning = Finding(
        name="roller-speed",
        severity="ok",
        sentence=f"the roller turns on its pin at a mean speed of {speed:.6g} rev/min",
        value=speed,
        unit="rev/min",
    )
    required = None if data.life is None else data.life / HOUR
    if life.seconds is None:
        unlimited = (
            "nothing presses the roller on its flank, so the life of its bearing has no limit"
        )
        return (Finding("roller-life", "ok", unlimited, limit=required, unit="h"), turning)
    hours = life.seconds / HOUR
    known = f"over {LONGEST:,.0f}" if hours > max(LONGEST, required or 0.0) else f"{hours:.6g}"
    text = f"basic rating life of the roller bearing {known} h"
    heavy = life.load > HEAVY * data.rating
    most = HEAVY * data.rating
    return (
        limit_finding("roller-life", text, hours, required, "h", least=True),
        Finding(
            name="equivalent-roller-load",
            severity="warning" if heavy else "ok",
            sentence=(
                f"equivalent load on the roller bearing {life.load:.6g} N,"
                f" {'above' if heavy else 'at most'} {most:g} N, half of its load rating"
                + (": its life is uncertain" if heavy else "")
            ),
            value=life.load,
            limit=most,
            unit="N",
        ),
        turning,
    )


# -- life -----------------------------------------------------------------------------------------
# Basic rating life of the roller bearing.
#
# L10 = (C/P)^p million turns of the roller, p = 10/3 for roller bearings and 3 for ball bearings
# (ISO 281:2007, basic rating life), with the dynamic load rating C and the equivalent load P. Under
# a varying load, damage is proportional to its p-th power and to the turns made under it (Palmgren
# and Miner), so P^p is the mean of F^p over the turns of the roller: with F and the rate nu of the
# roller per cam angle,
#
#     P^p = int F^p |nu| dphi / int |nu| dphi.
#
# The roller rolls on its flank without slip. Relative to the turning cam its centre moves along the
# flank by |Z'| per cam angle, and the follower turns at the rate chi' in the fixed frame. So the
# roller turns relative to its pin at nu = |Z'|/r_R - s (1 - sigma chi') per cam angle, with s = +1
# on the inner flank and -1 on the outer one, and the sense of rotation sigma (composition of the
# angular velocities of roller, cam and follower).


EXPONENTS: Final[Mapping[str, float]] = {"roller": 10.0 / 3.0, "ball": 3.0}
"""p of the bearings."""

TURNS: Final = 1e6
"""Turns of the roller that a bearing withstands under its load rating."""


@dataclass(frozen=True, slots=True)
class Life:
    """The life of the bearing.

    Attributes
    ----------
    load : P [N].
    speed : mean rate at which the roller turns on its pin [rad/s].
    seconds : L10 [s]; None if unlimited, because there is no load.
    load_error, speed_error, error : estimates of the relative errors of `load`, `speed` and
        `seconds`.
    """

    load: float
    speed: float
    seconds: float | None
    load_error: float
    speed_error: float
    error: float


def spin(contact: LineContact, phi: FloatArray, side: Side, sense: FloatArray) -> FloatArray:
    """(n,) nu, turns of the roller on its pin per turn of the cam, positive if it rolls forwards.

    `sense` (n,) is s, the flank on which it rolls.
    """
    subject = contact.subject
    relative = subject.state.curve.relative_jet(phi, side, order=1)
    rolling = np.hypot(relative.u, relative.v) / subject.cam.follower.roller_radius
    return np.asarray(rolling - sense * (1.0 - subject.cam.rotation * relative.turning))


def rolling_life(
    contact: LineContact,
    edges: FloatArray,
    course: TimeCourse,
    rating: float,
    exponent: float,
    tolerance: float,
) -> Life:
    """The life for the dynamic load rating `rating` [N] and p `exponent`, to the relative
    `tolerance`.

    Force and motion are smooth between neighbouring `edges` (k,) [rad] from 0 to 2 pi.

    Raises
    ------
    EffectError
        If the integrals do not reach the tolerance.
    """

    def turning(phi: FloatArray) -> FloatArray:
        return spin(contact, phi, "right", contact.carried(phi, "right")[1])

    def wear(phi: FloatArray) -> FloatArray:
        load, sense = contact.carried(phi, "right")
        turns = np.abs(spin(contact, phi, "right", sense))
        return np.asarray((load / rating) ** exponent * turns)

    share = 0.5 * tolerance  # the estimate also contains the rounding of the sum
    # |nu| has a kink where the roller reverses its spin.
    borders = with_roots(turning, edges)
    turns = piecewise_integral(lambda phi: np.abs(turning(phi)), borders, share)
    worn = piecewise_integral(wear, borders, share)
    duration = period(course)
    speed = turns.value / duration
    turned = turns.error / turns.value
    if not worn.value > 0.0:
        return Life(0.0, speed, None, 0.0, turned, 0.0)
    error = worn.error / worn.value
    if max(error, turned) > tolerance:
        raise tolerance_error(
            "the life of the roller bearing", max(error, turned), "itself", tolerance
        )
    return Life(
        load=rating * (worn.value / turns.value) ** (1.0 / exponent),
        speed=speed,
        seconds=TURNS * TURN * duration / worn.value,
        # P is the p-th root of a quotient of both integrals.
        load_error=(error + turned) / exponent,
        speed_error=turned,
        error=error,
    )


# -- line contact ---------------------------------------------------------------------------------
# The contact of roller and flank over the cam angle: force, relative curvature, pressure.
#
# Both are cylinders with parallel axes. A flank is the parallel of the pitch curve at the distance
# d = -s r_R, with s = +1 for the inner flank and -1 for the outer one. It has the curvature
# kappa/(1 + d kappa) if the pitch curve has kappa (Wirsig eqs. 2.53, 2.54: the radius of curvature
# of a parallel is longer by d). The disc lies outside its outer flank, which counts mirrored. The
# relative curvature is
#
#     1/R = 1/r_R + s kappa/(1 + d kappa) = 1/(r_R (1 + d kappa)),       R = r_R (1 + d kappa).
#
# In a groove with side clearance c, d = -s (r_R + c/2), and the same sum gives
#
#     R = r_R (1 + d kappa)/(1 - s c/2 kappa).
#
# A flat face has no curvature: R = 1/kappa there, the radius of curvature of the cam.
#
# So R is 0 at a cusp of the flank and nowhere else, and a flank without undercut is never curved
# more tightly than the roller that runs on it.


CUSP: Final = 1e-12
"""Values of 1 + d kappa up to here are a rounded 0, a cusp."""


@dataclass(frozen=True, slots=True, eq=False)
class LineContact:
    """The line contact.

    Attributes
    ----------
    subject : the design.
    normal : force of the cam on the follower [N], positive where the inner flank carries.
    modulus : E* [MPa].
    width : L [mm].
    """

    subject: Subject
    normal: Quantity
    modulus: float
    width: float

    @property
    def scale(self) -> float:
        """r_R [mm], the scale for detecting a cusp; r_G with a flat face."""
        follower = self.subject.cam.follower
        return follower.roller_radius or follower.base_radius

    def carried(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) force F of the follower on a flank [N], 0 or more, and (n,) which flank.

        A flank on which no roller runs carries nothing: there the roller has lifted off.
        """
        normal = self.normal(phi, side)
        if self.subject.cam.contact.closed_by_form:
            return np.abs(normal), np.where(normal < 0.0, float(OUTER), float(INNER))
        sense = self.subject.cam.contact.push
        return np.maximum(sense * normal, 0.0), np.full(len(phi), float(sense))

    def curvature(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) of the pitch curve [1/mm], positive where it is convex.

        Raises
        ------
        EffectError
            Where the pitch curve has a cusp.
        """
        try:
            return self.subject.state.curve.curvature(phi, side)
        except GeometryError as error:
            raise EffectError(f"there is no contact pressure: {error.message}") from error

    def load_and_radius(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) F [N] and (n,) R [mm], which is 0 on a corner of the disc."""
        load, sense = self.carried(phi, side)
        kappa = sense * self.curvature(phi, side)
        cam, state = self.subject.cam, self.subject.state
        radius = cam.follower.contact_radius(kappa, cam.disc.flank_distance)
        # A corner of the disc has no radius: any load makes the pressure infinite.
        return load, np.where(state.on_corner(phi, side), 0.0, radius)

    def square(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) p^2 [MPa^2], smooth where F and the curvature are; 0 without force.

        Raises
        ------
        EffectError
            Where a cusp or undercut is loaded.
        """
        load, radius = self.load_and_radius(phi, side)
        loaded = load > 0.0
        beyond = loaded & (radius <= CUSP * self.scale)
        if np.any(beyond):
            self._refuse(float(phi[beyond][0]), float(np.min(radius[beyond])))
        squares = np.zeros(len(phi))
        # p^2 = F E* / (pi L R).
        share = self.modulus / (math.pi * self.width)
        np.divide(share * load, radius, out=squares, where=loaded)
        return squares

    def pressure(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) p [MPa], see `square`."""
        return np.sqrt(self.square(phi, side))

    def refuse_cusps(self, edges: FloatArray) -> None:
        """Raise EffectError if a cusp or undercut is loaded between `edges` (k,) [rad]."""
        scale = self.scale

        def loaded_radius(phi: FloatArray, side: Side) -> FloatArray:
            load, radius = self.load_and_radius(phi, side)
            # Without load any radius will do; this one is no cusp.
            return np.where(load > 0.0, radius, scale)

        lowest = piecewise_lowest(loaded_radius, edges)
        if lowest.value <= CUSP * scale:
            self._refuse(lowest.place, lowest.value)

    def _refuse(self, angle: float, radius: float) -> NoReturn:
        value = radius / self.scale
        what = "a cusp of the flank" if value >= -CUSP else "an undercut flank"
        what = CORNERS.get(self.subject.state.model, what)
        touching = self.subject.cam.follower.touching
        raise EffectError(
            f"the pressure is infinite {at_angle(angle)}: {what} carries the {touching} there; 1 +"
            f" d kappa is {value:.6g} and must be above 0",
            finding="infinite-contact-pressure",
            value=value,
            limit=0.0,
            cam_angle=angle % TURN,
        )


CORNERS: Final[dict[Model, str]] = {
    "outline": "a sharp corner of the trimmed flank",
    "written": "a vertex of the written contour",
}
"""What holds the follower where the pressure is infinite, by the motion of the state."""

GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)

SHEAR_SHARE: Final[float] = GOLDEN**2.5
"""Largest shear below the contact as a share of the pressure, 0.30028."""

SHEAR_DEPTH: Final = math.sqrt(GOLDEN)
"""Its depth as a share of the half width, 0.78615."""


def largest_pressure(load: float, modulus: float, radius: float) -> float:
    """p [MPa] for F/L `load` [N/mm], E* `modulus` [MPa] and R `radius` [mm] above 0."""
    return math.sqrt(load * modulus / (math.pi * radius))


def half_width(load: float, modulus: float, radius: float) -> float:
    """b [mm] for F/L `load` [N/mm], E* `modulus` [MPa] and R `radius` [mm] above 0."""
    return math.sqrt(4.0 * load * radius / (math.pi * modulus))


def needed_radius(load: float, modulus: float, pressure: float) -> float:
    """R [mm] at which the largest pressure is `pressure` [MPa] above 0, see `largest_pressure`."""
    return load * modulus / (math.pi * pressure * pressure)


def roller_radii(needed: float, curvature: float) -> tuple[float, float] | None:
    """Range of roller radii, from and to [mm], for which R is at least `needed` [mm].

    Parameters
    ----------
    needed : the R needed, 0 or more.
    curvature : of the pitch curve, positive if convex towards the roller [1/mm]; it is unchanged.

    Returns
    -------
    The upper end is infinite where the path is straight or concave; None if no radius will do.

    R = r (1 - r kappa) for the roller radius r, see
    `camgeo.dynamics.effects.contact_pressure`. On a convex path it has a maximum, 1/(4
    kappa), at half the radius of curvature. The lower root of the quadratic equation is computed
    from the upper one, to avoid cancellation.
    """
    # The discriminant of kappa r^2 - r + R = 0.
    rest = 1.0 - 4.0 * needed * curvature
    if rest < 0.0:
        return None
    root = 1.0 + math.sqrt(rest)
    return 2.0 * needed / root, root / (2.0 * curvature) if curvature > 0.0 else math.inf
