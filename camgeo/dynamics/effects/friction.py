"""Effect `friction`: Coulomb, rolling and viscous friction, and the margin against jamming."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Final

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.dynamics.effects.bearing_friction import Rubbing
from camgeo.dynamics.effects.contact import (
    INNER,
    OUTER,
    carrier,
    holds_both_ways,
    require_convex,
    sliding,
)
from camgeo.dynamics.effects.effect import Column, Quantity, Request, Subject, driving_slider
from camgeo.dynamics.effects.forces import Force, FreeForce
from camgeo.dynamics.effects.loads import guide_ends
from camgeo.dynamics.effects.results import Bearing, Friction
from camgeo.dynamics.effects.tables import FrictionCoefficients
from camgeo.dynamics.effects.wording import at_angle, over_range
from camgeo.errors import EffectError, GeometryError
from camgeo.kinematics.mechanism.linkage import first_locked_place
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.motion import Motion
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged, read_only
from camgeo.numeric.extremes import piecewise_lowest, roots_on_grid, sample_grid, stretch_below
from camgeo.numeric.kept import Answers
from camgeo.units import TURN


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
    statics = friction_statics(subject, data)
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


def friction_statics(subject: Subject, data: FrictionCoefficients) -> Statics:
    """The friction that grows with the normal force."""
    motion = subject.state.motion
    senses = motion_senses(motion, subject.state.smooth_angles)
    start = float(subject.drive.motion.jet(np.zeros(1), "right", 1)[0, 0])
    return Statics(subject, data, senses, start)


def _borders(statics: Statics, edges: FloatArray) -> FloatArray:
    """(k,) cam angles [rad] at which an angular velocity, a reaction or a direction changes its
    sign on either flank.
    """
    angles = [edges]
    if statics.data.face and statics.swing:
        angles.append(
            roots_on_grid(lambda phi: statics.state(phi, "right", 1).slip, sample_grid(edges))
        )
    for sense in (INNER, OUTER):

        def spin(phi: FloatArray, sense: int = sense) -> FloatArray:
            return statics.state(phi, "right", sense).spin

        if statics.data.roller_pin:
            angles.append(roots_on_grid(spin, sample_grid(edges)))
        cuts = merged(np.concatenate(angles))

        def signed(phi: FloatArray, sense: int = sense) -> FloatArray:
            state = statics.state(phi, "right", sense)
            guided = () if statics.swing else (state.near, state.far)
            return np.stack((state.sine, state.cosine, *guided))

        angles.append(roots_on_grid(signed, sample_grid(cuts)))
    return np.mod(merged(np.concatenate(angles[1:])), TURN)


def _force(subject: Subject, data: FrictionCoefficients, borders: FloatArray) -> Force:
    """The friction that does not depend on the normal force.

    Viscous: Q = -c ds/dt ds/dq along the guide, which is -c dq/dt for the follower itself; Coulomb
    friction of a slider: Q = -F sign(ds/dt) ds/dq, by virtual work.
    """
    linkage = driving_slider(subject)
    if linkage is not None and (data.slider or data.guide_viscous):
        far = _slider_friction(subject, data, linkage)

        def coefficients(phi: FloatArray, side: Side) -> FloatArray:
            rows = far(phi, side) * linkage.per_follower(subject.state.output.jet(phi, side)[0])
            if data.pivot_viscous:
                rows[1] -= data.pivot_viscous * subject.state.motion.jet(phi, side, 1)[1]
            return np.asarray(rows)

        return Force(
            "friction",
            coefficients,
            borders=borders,
            free_force=_free_force(subject, data),
            far=far,
        )
    viscous = data.pivot_viscous + data.guide_viscous  # a follower has only one of the two

    def viscous_friction(phi: FloatArray, side: Side) -> FloatArray:
        rows = np.zeros((4, len(phi)))
        if viscous:
            rows[1] = -viscous * subject.state.motion.jet(phi, side, 1)[1]
        return rows

    return Force(
        "friction", viscous_friction, borders=borders, free_force=_free_force(subject, data)
    )


def _free_force(subject: Subject, data: FrictionCoefficients) -> FreeForce:
    """The friction on a follower that is off the cam, see `FreeForce`."""
    far = subject.drive.far_end
    if far is None or driving_slider(subject) is None:
        viscous = data.pivot_viscous + data.guide_viscous
        return lambda _phi, _q, rate: -viscous * rate

    def free_force(phi: FloatArray, q: FloatArray, rate: FloatArray) -> FloatArray:
        slide = far.jet(phi, q)[1]
        pace = slide * rate
        force = -(data.slider * np.sign(pace) + data.guide_viscous * pace) * slide
        return np.asarray(force - data.pivot_viscous * rate)

    return free_force


def _slider_friction(
    subject: Subject, data: FrictionCoefficients, linkage: SliderCrank
) -> Quantity:
    """(4, n) coefficients of friction along the stroke; EffectError where the slider is locked."""
    output = subject.state.output
    locked = first_locked_place(linkage, output)
    if locked is not None:
        raise EffectError(
            f"the rocker cannot move the slider against its friction: {at_angle(locked[0])}, stroke"
            f" {locked[1]:.6g} mm, the coupler is square to the guide",
            cam_angle=locked[0] % TURN,
        )
    strokes = motion_senses(output, subject.state.smooth_angles)

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        rows = np.zeros((4, len(phi)))
        rows[0] = -data.slider * strokes(phi, side)
        rows[1] = -data.guide_viscous * output.jet(phi, side, 1)[1]
        return rows

    return coefficients


# -- jamming --------------------------------------------------------------------------------------
# The margin of the follower against jamming.
#
# If the contact force is too oblique, a harder push only presses the follower harder into its guide
# or bearing, and does not move it (Rothbart, Cam Design Handbook, chapter 6, largest pressure angle
# of a translating follower; Norton, Cam Design and Manufacturing Handbook, chapter 7, on pressure
# angles; Volmer, Kurvengetriebe, on the transmission angle).


NEAR: Final = math.radians(5.0)
"""A smaller margin [rad] gives a warning: the usual scatter of friction coefficients, 0.1 to 0.2,
is about 5 degrees of the friction angle."""

ROUNDING: Final = 1e-12
"""A margin [rad] up to this is 0: a rounded transmission angle of 0."""

UNDRIVEN: Final = math.pi
"""Placeholder for the margin [rad] where the cam does not push; larger than any margin."""

WORDING: Final = {
    "roller": (
        (
            "transmission angle above the jamming limit by at least {value:.4f} deg, closest to it"
            " {place}"
        ),
        "transmission angle is below the limit",
    ),
    "face": (
        (
            "the contact force may lean at least {value:.4f} deg further before the follower jams,"
            " closest to jamming {place}"
        ),
        "contact force leans too far",
    ),
}
"""Sentence for the margin, and the fault if there is none. On a flat face the direction of the
contact force is fixed."""


def driving_margin(statics: Statics, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) [rad] margin for the flank with which the cam drives the follower.

    That is the flank on which the roller runs. In a groove, or between two discs, it is the one
    that pushes in the direction of motion, and the inner or main one during a dwell.
    """
    contact = statics.subject.cam.contact
    if not holds_both_ways(statics.subject):
        return statics.margin(phi, side, contact.push)
    inner, outer = (statics.margin(phi, side, sense) for sense in (1, -1))
    return np.where(_drive(statics, phi, side) < 0.0, outer, inner)


def _drive(statics: Statics, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) +1 where the inner flank drives the follower, -1 where the other does, 0 in a dwell."""
    sine = statics.state(phi, side, 1).sine
    return np.where(sine < 0.0, -1.0, 1.0) * statics.senses(phi, side)


def column(statics: Statics, borders: FloatArray) -> Column:
    """The margin over the cam angle [deg]."""

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.degrees(driving_margin(statics, phi, side))

    return Column("jamming margin", "deg", values, 0.0, borders)


def jamming_margin(statics: Statics, edges: FloatArray) -> tuple[Finding, ...]:
    """The smallest margin where the cam pushes the follower; no finding if it never does.

    `edges` (k,) are the cam angles [rad] from 0 to 2 pi between which the margin is smooth.
    """
    contact, both = statics.subject.cam.contact, holds_both_ways(statics.subject)

    def driven(phi: FloatArray, side: Side) -> FloatArray:
        drive = _drive(statics, phi, side)
        pushes = drive != 0.0 if both else drive == contact.push
        return np.where(pushes, driving_margin(statics, phi, side), UNDRIVEN)

    lowest = piecewise_lowest(driven, edges)
    if lowest.value == UNDRIVEN:
        return ()
    value, near = math.degrees(lowest.value), math.degrees(NEAR)
    sentence, fault = WORDING[statics.subject.cam.follower.touching]
    sentence = sentence.format(value=value, place=at_angle(lowest.place))
    severity: Severity = "ok"
    limit = near
    cam_range = None
    if lowest.value <= ROUNDING:
        severity, limit = "broken", 0.0
        cam_range = stretch_below(lambda phi: driven(phi, "right") - ROUNDING, edges, lowest.place)
        sentence = f"the follower jams: the {fault} by {-value:.4f} deg {at_angle(lowest.place)}"
        if cam_range is not None:
            sentence += f", and {over_range(cam_range)}"
    elif lowest.value < NEAR:
        severity = "warning"
        sentence += f", less than {near:g} deg"
    return (
        Finding(
            name="jamming-margin",
            severity=severity,
            sentence=sentence,
            value=value,
            limit=limit,
            unit="deg",
            cam_angle=lowest.place,
            cam_range=cam_range,
        ),
    )


# -- statics --------------------------------------------------------------------------------------
# Statics of follower, roller or face, and cam with friction, per unit of the normal force.
#
# n = i sigma t is the outward normal of the pitch curve, t = Z'/|Z'| its tangent. The cam presses
# on the roller with |N| s n, with s = +1 on the inner flank and -1 on the outer one, at the point
# -s r_R n relative to the roller's centre. Angular velocities are counter-clockwise positive and
# per unit of the cam's speed.
#
# The roller rolls without slip. Equal velocities of roller and cam at the contact give its angular
# velocity relative to the cam, omega_rc = -s sigma |Z'| / r_R, and relative to the follower,
# omega_rf = sigma + omega_rc - chi', with the angular velocity chi' of the rocker, 0 in a guide.
# The roller has no mass. On it act, per unit of |N|,
#
#     m_p = -mu_p (d_p / 2) sign(omega_rf)    the friction of its bearing, of radius d_p / 2,
#     m_r = -f sign(omega_rc) = s sigma f     the rolling friction, of lever f, and
#     f_t = -s sigma (m_p + m_r) / r_R        along t, from the cam, by balance of moments
#
# (Rothbart, Cam Design Handbook, chapter 8, forces; Volmer, Kurvengetriebe, friction of the roller;
# rolling friction as a shifted normal force is in any textbook). The bearing of the roller is
# loaded by |N|; the small f_t is neglected there.
#
# A flat face slides. With its coefficient mu_f and the sliding g along t
# (`camgeo.dynamics.effects.contact`)
#
#     f_t = -mu_f sign(g),
#
# and it dissipates |f_t g|. There is no roller: m_p = m_r = 0.
#
# On the follower act s n + f_t t at the roller's centre, or at the contact of the face, and the
# moment -m_p. In a guide this is a side force S and a moment M = -m_p or, with the contact of a
# face at the distance e to the right of the guide's axis, M = s e. With the near end at the
# distance a outwards of the roller's centre, or of the face, and the far end b beyond it, balance
# of forces and moments across the guide gives
#
#     R_2 = (a S + M) / b,    R_1 = -((a + b) S + M) / b,    H = |R_1| + |R_2|,
#
# which without M is H = |S| (2 a + b) / b for a >= 0, and |S| for a roller centre between the ends
# (Rothbart, chapter 6, follower overhang A = a and bearing length B = b; Norton, Cam Design and
# Manufacturing Handbook, chapter 7, forces on a translating roller follower). The diameter of the
# stem is neglected. All this is seen along the guide of the main follower. What touches the return
# disc of a carriage, or the cam on the opposite side of a yoke, is turned against that by half a
# turn, and farther from the near end by the distance of the two.
#
# Friction takes mu H in the guide and mu (d / 2) |s n + f_t t| in the pivot of a rocker. So much is
# due to the contact; whatever else loads guide and pivot is added to it in
# `camgeo.dynamics.effects.bearing_friction`.


SHARES: Final = (0.25, 0.5, 0.75)
"""Shares of a piece where the velocity is evaluated; the largest decides the sense."""

EDGE_ROUNDING: Final = 8.0 * math.ulp(TURN)
"""An angle closer than this [rad] to an edge is that edge, in any turn."""


@dataclass(frozen=True, slots=True, eq=False)
class Senses:
    """The sense of a velocity over the turn, +1, -1, or 0 during a dwell.

    The sign of the velocity itself will not do: it is 0 at both ends of every move, where Coulomb
    friction is not.

    Attributes
    ----------
    edges : (k,) cam angles [rad] from 0 to 2 pi, ascending, between which the sense is constant.
    signs : (k - 1,) the senses.
    """

    edges: FloatArray
    signs: FloatArray

    def __call__(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) the sense at `phi` (n,) [rad], on the given side."""
        # An angle that is an edge but for rounding belongs to the piece on its given side.
        nudge = EDGE_ROUNDING if side == "right" else -EDGE_ROUNDING
        piece = np.searchsorted(self.edges, np.mod(phi, TURN) + nudge) - 1
        return self.signs[piece % len(self.signs)]


def motion_senses(motion: Motion, edges: FloatArray) -> Senses:
    """The senses of `motion` between `edges` (k,) [rad]."""
    low, span = edges[:-1], np.diff(edges)
    velocity = np.stack([motion.jet(low + share * span, "right", 1)[1] for share in SHARES])
    # A single sample may lie where the velocity is rounding.
    fastest = np.argmax(np.abs(velocity), axis=0)
    return Senses(edges, np.sign(velocity[fastest, np.arange(len(low))]))


@dataclass(frozen=True, slots=True, eq=False)
class ContactState:
    """The contact at n cam angles, per unit of |N|, read-only.

    Attributes
    ----------
    velocity : q' [mm or rad per rad].
    spin : omega_rf, of the roller relative to the follower.
    spin_to_cam : omega_rc.
    pin_moment, rolling_moment : m_p, m_r on the roller [mm].
    tangential : f_t.
    slip : g, along t [mm/rad]; 0 for a roller.
    reach : |dW/dq|, 1 or the lever arm about the pivot [mm/rad], l_3 with a roller.
    sine, cosine : dn/dq and t dW/dq over the reach, both signed: of the transmission angle.
    near, far : R_1 and R_2, to the right looking along the guide; -S and 0 without a guide length.
    overhang : a [mm]; 0 for a rocker.
    tilt : M, counter-clockwise [mm]; 0 for a rocker.
    force : s n + f_t t, in the drawing.
    """

    velocity: FloatArray
    spin: FloatArray
    spin_to_cam: FloatArray
    pin_moment: FloatArray
    rolling_moment: float
    tangential: FloatArray
    slip: FloatArray
    reach: FloatArray
    sine: FloatArray
    cosine: FloatArray
    near: FloatArray
    far: FloatArray
    overhang: FloatArray
    tilt: FloatArray
    force: ComplexArray

    def __post_init__(self) -> None:
        for attribute in fields(self):
            value = getattr(self, attribute.name)
            if isinstance(value, np.ndarray):
                read_only(value)


@dataclass(frozen=True, slots=True, eq=False)
class Statics:
    """Friction that grows with the normal force.

    Attributes
    ----------
    subject : the design.
    data : what the scene says of friction.
    senses : of the follower's motion.
    start : q at cam angle 0 [mm or rad].
    """

    subject: Subject
    data: FrictionCoefficients
    senses: Senses
    start: float
    _states: Answers[ContactState] = field(default_factory=Answers, init=False, repr=False)

    @property
    def swing(self) -> int:
        """Angle of the follower per unit of q, counter-clockwise: +1, -1, or 0 in a guide."""
        return self.subject.cam.follower.swing_sense

    def state(self, phi: FloatArray, side: Side, sense: int) -> ContactState:
        """The contact on the side `sense`, see `camgeo.dynamics.effects.contact`; kept for the
        latest cam angles, as forces, torques and loads follow from it one by one.

        Raises
        ------
        GeometryError
            Where the pitch curve has a cusp, Z' = 0.
        """
        return self._states.recall(lambda: self._state(phi, side, sense), (side, sense), phi)

    def _state(self, phi: FloatArray, side: Side, sense: int) -> ContactState:
        subject, sense = carrier(self.subject, sense)
        data = self.data
        follower, sigma = subject.cam.follower, subject.cam.rotation
        jet = subject.state.motion.jet(phi, side, 1)
        relative = subject.state.curve.relative_jet(phi, side, 1)
        speed = subject.state.curve.speed(relative)
        slip = np.zeros_like(speed)
        # A knife edge or a face does not roll, and has neither pin nor rolling friction.
        per_radius = 1.0 / follower.roller_radius if follower.roller_radius > 0.0 else 0.0
        spin_to_cam = (-sense * sigma * per_radius) * speed
        spin = (sigma + spin_to_cam) - relative.turning
        pin = (-0.5 * data.roller_pin * data.roller_pin_diameter) * np.sign(spin)
        rolling = sense * sigma * data.rolling
        tangential = (-sense * sigma * per_radius) * (pin + rolling)
        if data.face:
            slip = sliding(subject, phi, side)
            tangential = -data.face * np.sign(slip)
        outward = math.copysign(1.0, follower.reach)
        # v of a rocker has the opposite sign of sigma times that of a guide, see `relative_jet`.
        ahead = -sigma * outward if self.swing else outward
        sine, cosine = outward * relative.u / speed, ahead * relative.v / speed
        across, overhang, tilt = np.zeros((3, len(speed)))
        near, far = -across, across
        if not self.swing:
            # n = (-sigma v, u) / |Z'| and t = (sigma u, v) / |Z'|, across the guide and along it
            main = self.subject.cam.follower
            onward = math.copysign(1.0, main.reach)
            facing = onward * outward
            across = facing * sigma * (tangential * relative.u - sense * relative.v) / speed
            spacing = (main.way.conjugate() * (main.start_arm - follower.start_arm)).real
            overhang = data.guide_overhang + onward * (spacing - (jet[0] - self.start))
            # the force on a roller passes through the axis of the guide
            offset = follower.offset + facing * data.guide_offset
            tilt = sense * (relative.along[0] - offset) - pin
            near, far = guide_ends(across, tilt, overhang, data.guide_length)
        reach = np.abs(relative.reach) + np.zeros_like(speed)
        tangent = (relative.along[1] + 1j * relative.across[1]) / speed * np.exp(1j * relative.axis)
        force = (1j * sigma * sense + tangential) * tangent
        return ContactState(
            jet[1], spin, spin_to_cam, pin, rolling, tangential, slip, reach, sine, cosine, near,
            far, overhang, tilt, force,
        )  # fmt: skip

    def per_normal(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(2, n) generalised force on q [1 or mm/rad] and torque on the cam [mm], see `Friction`.

        By virtual work: f_t t dW/dq - m_p dchi/dq, minus mu H or mu d / 2 against the motion, with
        the point W of the follower at the contact; at the cam f_t (t W' - g) - omega_r m_p -
        omega_rc m_r, with the angular velocity omega_r of the roller. The power of the cam exceeds
        that of the follower by the losses in the bearings and at the contact.
        """
        contact = self.state(phi, side, sense)
        along = contact.reach * contact.tangential * contact.cosine
        force = (
            along - self.swing * contact.pin_moment - self.senses(phi, side) * self.drag(contact)
        )
        turning = contact.spin + self.swing * contact.velocity  # omega_r
        torque = along * contact.velocity - contact.tangential * contact.slip
        torque -= turning * contact.pin_moment + contact.spin_to_cam * contact.rolling_moment
        return np.stack((force, torque))

    def at_contact(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(n,) torque on the cam [mm], see `Friction`: each moment or force by the velocity with
        which its parts move on each other, -f_t g - omega_rf m_p - omega_rc m_r.
        """
        contact = self.state(phi, side, sense)
        lost = contact.tangential * contact.slip + contact.spin * contact.pin_moment
        return np.asarray(-(lost + contact.spin_to_cam * contact.rolling_moment))

    def bearing(self, phi: FloatArray, side: Side, sense: int) -> Bearing:
        """See `Friction`."""
        contact = self.state(phi, side, sense)
        return Bearing(contact.tangential, contact.tilt, contact.overhang)

    @property
    def lever(self) -> float:
        """Friction on q per unit of the load of pivot [mm] or guide."""
        data = self.data
        return 0.5 * data.pivot * data.pivot_diameter if self.swing else data.guide

    @property
    def rubbing(self) -> Rubbing | None:
        """See `Friction`."""
        return Rubbing(self.lever, self.senses, self.loads) if self.lever else None

    def loads(self, phi: FloatArray, side: Side, sense: int) -> ComplexArray:
        """(k, n) of the contact on pivot or guide, see `Rubbing`."""
        contact = self.state(phi, side, sense)
        if self.swing:
            return -contact.force[np.newaxis]
        ends = (contact.near,) if self.data.guide_length is None else (contact.near, contact.far)
        return np.stack(ends).astype(np.complex128)

    def drag(self, contact: ContactState) -> FloatArray:
        """(n,) [1 or mm] friction of guide or pivot along q, with no load but the contact."""
        if self.swing:
            return np.asarray(self.lever * np.hypot(1.0, contact.tangential))
        return np.asarray(self.lever * (np.abs(contact.near) + np.abs(contact.far)))

    def margin(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(n,) [rad] margin of the transmission angle against jamming.

        The transmission angle mu minus the angle at which a cam that pushes with the flank `sense`
        jams, all else being equal; it is above 0 exactly where the follower does not jam. With the
        signs of the reactions fixed, the force along the path is A sin mu + B cos mu - C per unit
        of |N|, so the margin is arccos(C / hypot(A, B)) - |pi/2 - mu - arctan2(B, A)|. Guide
        friction alone gives A = 1, B = -mu (2 a + b) / b, C = 0: the largest pressure angle of
        Rothbart, chapter 6, tan alpha = b / (mu (2 a + b)). A pivot alone gives sin mu = mu_b d /
        (2 l_3), the friction circle.
        """
        contact, data = self.state(phi, side, sense), self.data
        subject, sense = carrier(self.subject, sense)
        pushed = sense * _sign(contact.sine)  # direction of q in which this flank pushes
        ahead = pushed * _sign(contact.cosine)  # +1 where t points in the direction of the push
        helping = ahead * contact.tangential
        first, second = np.ones_like(helping), helping
        if self.swing:
            loss = self.drag(contact) + pushed * self.swing * contact.pin_moment
            third = loss / contact.reach
        else:
            # S = turned (cos mu - helping sin mu), along the main guide
            outward = math.copysign(1.0, self.subject.cam.follower.reach)
            turned = -subject.cam.rotation * outward * ahead * pushed * sense
            near, far = -_sign(contact.near), _sign(contact.far)
            length = data.guide_length
            if length is None:
                share, offset = near, np.zeros_like(near)
            else:
                share = (far * contact.overhang + near * (contact.overhang + length)) / length
                offset = -(far + near) * contact.tilt / length
            lever = data.guide * turned * share
            first, second = first + lever * helping, helping - lever
            third = -data.guide * offset
        size = np.hypot(first, second)
        transmission = np.arctan2(np.abs(contact.sine), np.abs(contact.cosine))
        deviation = 0.5 * math.pi - transmission - np.arctan2(second, first)
        # Into -pi to pi: the phase may be given in another turn.
        deviation -= TURN * np.round(deviation / TURN)
        return np.asarray(np.arccos(np.clip(third / size, -1.0, 1.0)) - np.abs(deviation))


def _sign(values: FloatArray) -> FloatArray:
    """(n,) +1 or -1; +1 for 0."""
    return np.where(values < 0.0, -1.0, 1.0)
