"""Effect `spring`: a linear spring, its travel, and the stress of its wire."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.dynamics.effects.effect import (
    Column,
    Quantity,
    Request,
    Subject,
    driving_slider,
    scaled,
)
from camgeo.dynamics.effects.forces import Force, unmoved
from camgeo.dynamics.effects.results import HelicalSpring, Spring
from camgeo.dynamics.effects.tables import SpringData
from camgeo.dynamics.effects.wording import at_angle, degrees, over_range, placed
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linkage import first_locked_place
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.motion import Motion
from camgeo.numeric.arrays import SHARE, ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import (
    Extreme,
    Extremes,
    piecewise_extremes,
    piecewise_lowest,
    stretch_below,
)
from camgeo.units import TURN

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
    way = spring_travel(subject, data)
    torsion = data.kind == "torsion"
    preload, stiffness = data.preload, data.stiffness

    def magnitude(phi: FloatArray, side: Side) -> FloatArray:
        """F (n,) [N or N mm]."""
        return np.asarray(preload - stiffness * way(phi, side)[0])

    def on_follower(phi: FloatArray, side: Side) -> FloatArray:
        x, rate = way(phi, side)
        return (preload - stiffness * x) * rate

    far = subject.drive.far_end

    def free_force(phi: FloatArray, q: FloatArray, _rate: FloatArray) -> FloatArray:
        x, rate = way.evaluate(far.place(phi, q) if far is not None and way.per_stroke else q)
        return (preload - stiffness * x) * rate

    def on_slider(phi: FloatArray, side: Side) -> FloatArray:
        return way.per_stroke * magnitude(phi, side)

    unit, scale = ("N m", NEWTON_METRE) if torsion else ("N", 1.0)

    def displayed_force(phi: FloatArray, side: Side) -> FloatArray:
        return magnitude(phi, side) / scale

    extremes = piecewise_extremes(displayed_force, subject.state.smooth_angles)
    findings = [
        *force_findings(displayed_force, extremes, subject, unit),
        deflection(way, subject, torsion=torsion),
        *opening(way, subject),
    ]
    columns = [Column("spring torque" if torsion else "spring force", unit, displayed_force)]
    helical = data.helical
    if helical is not None:
        findings += [
            *_wire(helical),
            *_stresses(helical, extremes),
            *_closure(helical, extremes.highest),
            _buckling(helical),
        ]
        stress = scaled(magnitude, helical.stress_per_force)
        columns.append(Column("spring stress", "MPa", stress, helical.strength))
    return Spring(
        findings=tuple(findings),
        columns=tuple(columns),
        force=Force(
            "spring",
            unmoved(on_follower),
            free_force=free_force,
            far=unmoved(on_slider) if way.per_stroke else None,
        ),
        way=way,
        preload=preload,
        stiffness=stiffness,
        unit_of_preload=unit,
        unit_of_stiffness="N m/rad" if torsion else "N/mm",
        helical=helical,
        line=way.line,
        per_stroke=way.per_stroke,
    )


def spring_travel(subject: Subject, data: SpringData) -> Travel:
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
        return guide_spring(subject)
    if data.kind == "torsion":
        return torsion_spring(subject)
    if data.anchor is not None and data.attachment is not None:
        # x is how far the spring relaxes: one that is compressed relaxes as it gets longer.
        sense = 1.0 if data.kind == "compression" else -1.0
        return point_spring(subject, pivot, data.anchor, data.attachment, sense)
    linkage = driving_slider(subject)
    if linkage is None:
        raise GeometryError(
            "is missing: a spring on a rocker needs anchor and attachment, or kind torsion",
            key="effects.spring.anchor",
        )
    return slider_spring(subject, linkage)


def force_findings(
    force: Quantity, extremes: Extremes, subject: Subject, unit: str
) -> list[Finding]:
    """Largest and smallest force [`unit`], the `extremes`, and where it is below 0."""
    name = "torque" if unit == "N m" else "force"
    findings = [
        placed(
            f"{size}-spring-{name}",
            f"{size} spring {name} {extreme.value:.6g} {unit} {at_angle(extreme.place)}",
            extreme,
            unit,
        )
        for size, extreme in (("largest", extremes.highest), ("smallest", extremes.lowest))
    ]
    lowest = extremes.lowest
    if lowest.value < -SHARE * extremes.magnitude:
        slack = _below(force, subject.state.smooth_angles, lowest.place)
        findings.append(
            Finding(
                name="slack-spring",
                severity="warning",
                sentence=(
                    f"the spring {name} is below 0 {over_range(slack)}, {lowest.value:.6g} {unit}"
                    f" {at_angle(lowest.place)}: a real spring would be slack there, but the values"
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
    extremes = piecewise_extremes(lambda phi, side: way(phi, side)[0], subject.state.smooth_angles)
    farthest = max(extremes.highest, extremes.lowest, key=lambda extreme: abs(extreme.value))
    value = abs(math.degrees(farthest.value) if torsion else farthest.value)
    unit = "deg" if torsion else "mm"
    kind = "relaxed" if farthest.value > 0.0 else "tightened"
    place = farthest.place
    sentence = (
        f"largest spring deflection {value:.6g} {unit} {at_angle(place)}, {kind} since cam angle 0"
    )
    return placed("largest-spring-deflection", sentence, Extreme(value, place), unit)


def opening(way: Travel, subject: Subject) -> list[Finding]:
    """A warning where the spring presses away from the flank in use."""
    edges = subject.state.smooth_angles

    def closing(phi: FloatArray, side: Side) -> FloatArray:
        """With the sign of dx/dn towards the flank."""
        towards = closing_sense(subject) * outward(subject, phi, side)
        return np.asarray(towards * way(phi, side)[1])

    extremes = piecewise_extremes(closing, edges)
    if extremes.lowest.value >= -SHARE * extremes.magnitude:
        return []
    away = _below(closing, edges, extremes.lowest.place)
    return [
        Finding(
            name="spring-opens-contact",
            severity="warning",
            sentence=(
                f"the spring presses the {subject.cam.follower.touching} away from its flank"
                f" {over_range(away)}"
            ),
            cam_angle=extremes.lowest.place,
            cam_range=away,
        )
    ]


def _below(function: Quantity, edges: FloatArray, place: float) -> tuple[float, float]:
    """The range (from, to) [rad] around `place` in which `function` is below 0."""
    stretch = stretch_below(lambda phi: function(phi, "right"), edges, place)
    # Too short a range is its place alone.
    return stretch or (place % TURN, place % TURN)


# -- travel ---------------------------------------------------------------------------------------
# The travel of a spring over the cam angle.
#
# A `Travel` gives x (n,), how far the spring has relaxed since cam angle 0 [mm or rad], and dx/dq,
# its derivative by the follower's coordinate q. The effect of any kind of spring follows from these
# two: a linear spring with preload P and rate k pushes or pulls along x with
#
#     F = P - k x,      Q = F dx/dq,
#
# the generalised force by virtual work (Hooke's law; Norton, Cam Design and Manufacturing Handbook,
# chapters on modelling and on the dynamics of force-closed cams, where the preload closes the
# contact and the rate adds to it with the lift).


SHORTEST: Final = 1e-6
"""A spring shorter than this share of its lever arms has no definite direction."""


def closing_sense(subject: Subject) -> int:
    """Direction along the outward normal in which a spring must press: -1 inwards, +1 outwards.

    Inwards on the inner flank and in a groove, outwards on the outer flank.
    """
    return subject.cam.contact.main.sign


def outward(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) [mm^2/rad^2] with the sign of dn/dq (`PitchCurve.leverage`), defined without a
    normal.
    """
    follower = subject.cam.follower
    jet = subject.state.motion.jet(phi, side, 1 + follower.ahead)
    relative = follower.relative_jet(jet, subject.cam.rotation, 1)
    return np.asarray(follower.reach * relative.u)


@dataclass(frozen=True, slots=True)
class LineSpring:
    """A spring along the guide of a follower or slider, or a torsion spring about a pivot.

    Attributes
    ----------
    motion : along the guide or about the pivot: that of the follower or of the slider.
    start : its value at cam angle 0 [mm or rad].
    sense : +1 if the spring relaxes as the motion increases, -1 if it relaxes as it decreases.
    linkage : from the slider to the rocker, with dq/ds; None if the motion is the follower's own.
    way : direction of the guide in the drawing in which the motion increases; None about a pivot,
        or along the guide of a slider.
    """

    motion: Motion
    start: float
    sense: float
    linkage: SliderCrank | None = None
    way: complex | None = None

    @property
    def line(self) -> Callable[[FloatArray, Side], ComplexArray] | None:
        """See `Travel`."""
        way = self.way
        return None if way is None else lambda phi, _: np.full(len(phi), self.sense * way)

    @property
    def per_stroke(self) -> float:
        """See `Travel`."""
        return 0.0 if self.linkage is None else self.sense

    def __call__(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        return self.evaluate(self.motion.jet(phi, side, 1)[0])

    def evaluate(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """x (n,) and dx/dq (n,) at the value `place` (n,) of the motion."""
        rate = np.ones(len(place)) if self.linkage is None else self.linkage.per_follower(place)
        return self.sense * (place - self.start), self.sense * rate


@dataclass(frozen=True, slots=True)
class PointSpring:
    """A spring between a fixed point and one on the rocker.

    With the fixed point a and the point r on the rocker, both relative to the pivot, the spring has
    the length L = |r - a|, and r turns with the rocker: L^2 = |r|^2 + |a|^2 - 2 Re(conj(a) r), so
    L dL/dq = h Im(conj(a) r), with h = +1 if q is counter-clockwise positive. The elongation is
    computed from the difference of the squares, L^2 - L_0^2 = 2 Re(conj(a) (r_0 - r)), without
    cancellation.

    Attributes
    ----------
    motion : the rocker's.
    start : q at cam angle 0 [rad].
    swing_sense : h.
    attachment, anchor : r_0 = r at cam angle 0, and a [mm].
    sense : +1 for a compression spring, which relaxes as it gets longer, -1 for an extension
        spring, which relaxes as it gets shorter.
    per_stroke : see `Travel`.
    """

    motion: Motion
    start: float
    swing_sense: int
    attachment: complex
    anchor: complex
    sense: float
    per_stroke: float = 0.0

    def __call__(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        return self.evaluate(self.motion.jet(phi, side, 1)[0])

    def evaluate(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """x (n,) and dx/dq (n,) with the rocker at q = `place` (n,) [rad]."""
        half = self._half(place)
        lever = self.anchor.conjugate() * self.attachment
        turned = lever * np.exp(2j * half)
        # r - r_0 = r_0 exp(i half) 2 i sin(half)
        gain = 4.0 * np.sin(half) * (lever * np.exp(1j * half)).imag
        start_length = abs(self.attachment - self.anchor)
        length = np.abs(self._ahead(half))
        rate = self.swing_sense * turned.imag / length
        return self.sense * gain / (length + start_length), self.sense * rate

    def length(self, phi: FloatArray, side: Side) -> FloatArray:
        """L (n,) [mm]."""
        half = self._half(self.motion.jet(phi, side, 1)[0])
        return np.asarray(np.abs(self._ahead(half)))

    def line(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) unit vectors of the force on the rocker: away from the fixed end by compression."""
        ahead = self._ahead(self._half(self.motion.jet(phi, side, 1)[0]))
        return np.asarray(self.sense * ahead / np.abs(ahead))

    def _half(self, place: FloatArray) -> FloatArray:
        """(n,) [rad] half the angle by which r is turned."""
        return (0.5 * self.swing_sense) * (place - self.start)

    def _ahead(self, half: FloatArray) -> ComplexArray:
        """(n,) r - a [mm]."""
        return np.asarray(self.attachment * np.exp(2j * half) - self.anchor)


Travel = LineSpring | PointSpring
"""x (n,) [mm or rad] and dx/dq (n,) at n cam angles, see the module. Each has

evaluate : the same with the member that moves the spring at a place (n,) [mm or rad].
line : (n,) unit vectors in the drawing along which a force above 0 acts on the follower; None if it
    is a torque, or acts on a slider.
per_stroke : dx/ds, s the stroke of the slider that it acts on; 0 if it acts on the follower.
"""


def guide_spring(subject: Subject) -> LineSpring:
    """Along the guide of a translating follower; it relaxes towards the flank in use."""
    sense = closing_sense(subject) * subject.cam.follower.reach
    way = subject.cam.follower.way
    return LineSpring(subject.state.motion, _start(subject.drive.motion), sense, way=way)


def torsion_spring(subject: Subject) -> LineSpring:
    """About the pivot of a rocker; it relaxes as the follower turns towards the flank in use.

    The direction is that at cam angle 0, which changes only if the arm passes the line of centres.
    """
    lever = float(outward(subject, np.zeros(1), "right")[0])
    sense = closing_sense(subject) * float(np.sign(lever))
    return LineSpring(subject.state.motion, _start(subject.drive.motion), sense)


def slider_spring(subject: Subject, linkage: SliderCrank) -> LineSpring:
    """Along the slider's guide; it relaxes as the follower moves towards the flank in use.

    Raises
    ------
    GeometryError
        With key "effects.spring", if the direction of the slider that closes the contact changes
        over the turn: where the coupler is square to the guide, or the arm is on the line of
        centres.
    """
    stroke = subject.state.output
    locked = first_locked_place(linkage, stroke)
    if locked is not None:
        raise GeometryError(
            f"the slider cannot close the contact over the whole turn: {at_angle(locked[0])} the"
            " coupler is square to the guide",
            key="effects.spring",
        )
    # It has the sign of dn/ds: ds/dpsi may vanish at a dead centre, but never changes sign.
    extremes = piecewise_extremes(partial(outward, subject), subject.state.smooth_angles)
    if extremes.lowest.value < 0.0 < extremes.highest.value:
        raise GeometryError(
            f"the slider closes the contact by moving one way {at_angle(extremes.lowest.place)} and"
            " the"
            f" other way at {degrees(extremes.highest.place)}: the arm passes the line of centres",
            key="effects.spring",
        )
    outwards = 1.0 if extremes.highest.value > 0.0 else -1.0
    low = np.concatenate((np.zeros(1), subject.state.smooth_angles))
    slopes = linkage.per_follower(stroke.jet(low, "right", 1)[0])
    # All slopes have one sign, as the slider is not locked; the largest is the farthest from
    # rounding.
    slope = float(slopes[np.argmax(np.abs(slopes))])
    sense = closing_sense(subject) * outwards * float(np.sign(slope))
    return LineSpring(stroke, _start(subject.drive.plan), sense, linkage)


def point_spring(
    subject: Subject,
    pivot: complex,
    anchor: complex,
    attachment: complex,
    sense: float,
) -> PointSpring:
    """Between `anchor` and `attachment` at cam angle 0, both relative to the cam axis.

    Raises
    ------
    GeometryError
        With key "effects.spring.attachment", if it is at the pivot; with "effects.spring.anchor",
        if the attachment comes so close to it that the spring has no direction.
    """
    lever, fixed = attachment - pivot, anchor - pivot
    if lever == 0.0:
        raise GeometryError(
            "is at the pivot of the rocker, where a spring has no torque",
            key="effects.spring.attachment",
        )
    start = _start(subject.drive.motion)
    swing = subject.cam.follower.swing_sense
    way = PointSpring(subject.state.motion, start, swing, lever, fixed, sense)
    shortest = piecewise_lowest(way.length, subject.state.smooth_angles)
    if shortest.value <= SHORTEST * (abs(lever) + abs(fixed)):
        raise GeometryError(
            f"is {shortest.value:.3g} mm from the attachment {at_angle(shortest.place)}: the spring"
            " has no direction there",
            key="effects.spring.anchor",
        )
    return way


def _start(motion: Motion) -> float:
    return float(motion.jet(np.zeros(1), "right", 1)[0, 0])


# -- coils ----------------------------------------------------------------------------------------
# Stress, closure and buckling of a helical spring over the turn.


INDICES: Final = (4.0, 12.0)
"""Spring indices that can be wound well (Shigley, 8th ed., eq. 10-18)."""

OVERRUN: Final = 0.15
"""Share of the largest deflection that should be left to closure (as above, eq. 10-20)."""


def _wire(helical: HelicalSpring) -> tuple[Finding, Finding]:
    """The findings on the stiffness and the index of the spring."""
    stiffness, index = helical.stiffness, helical.index
    least, most = INDICES
    inside = least <= index <= most
    return (
        Finding(
            "spring-stiffness",
            "ok",
            f"stiffness of the helical spring {stiffness:.6g} N/mm",
            stiffness,
            unit="N/mm",
        ),
        Finding(
            "spring-index",
            "ok" if inside else "warning",
            f"spring index {index:.4g}, {'within' if inside else 'outside'} {least:g} to {most:g},"
            " in which springs are easily wound",
            index,
            most if index > most else least,
        ),
    )


def _stresses(helical: HelicalSpring, forces: Extremes) -> tuple[Finding, ...]:
    """Largest, smallest and solid stress, against the strength."""
    per_force, strength = helical.stress_per_force, helical.strength

    def verdict(stress: float, beyond: Severity) -> tuple[str, Severity]:
        if strength is None:
            return "; no strength of the wire is stated", "ok"
        if stress > strength:
            return f", above {strength:g} MPa", beyond
        return f", at most {strength:g} MPa", "ok"

    largest, smallest = (
        Extreme(per_force * end.value, end.place) for end in (forces.highest, forces.lowest)
    )
    solid = per_force * helical.solid_force
    words, severity = verdict(largest.value, "broken")
    closed, warned = verdict(solid, "warning")
    return (
        placed(
            "largest-spring-stress",
            f"largest shear stress of the spring {largest.value:.6g} MPa {at_angle(largest.place)}"
            f"{words}",
            largest,
            "MPa",
            strength,
            severity,
        ),
        placed(
            "smallest-spring-stress",
            f"smallest shear stress of the spring {smallest.value:.6g} MPa"
            f" {at_angle(smallest.place)}",
            smallest,
            "MPa",
        ),
        Finding(
            "solid-spring-stress",
            warned,
            f"shear stress of the spring with all coils touching, under {helical.solid_force:.6g}"
            f" N, {solid:.6g} MPa{closed}",
            solid,
            strength,
            "MPa",
        ),
    )


def _closure(helical: HelicalSpring, highest: Extreme) -> tuple[Finding, ...]:
    """The finding on how much farther than to its largest force the spring can be compressed; none
    if it is never compressed.
    """
    if not highest.value > 0.0:
        return ()
    solid = helical.solid_length
    shortest = helical.free_length - highest.value / helical.stiffness
    # Deflections from the free length are proportional to forces.
    overrun = helical.solid_force / highest.value - 1.0
    length = f"shortest length of the spring {shortest:.6g} mm {at_angle(highest.place)}"
    severity: Severity = "ok"
    if overrun < 0.0:
        sentence, severity = f"{length}: its coils touch at {solid:.6g} mm", "broken"
    else:
        little = overrun < OVERRUN
        sentence = (
            f"{length}; its coils touch at {solid:.6g} mm, after {100.0 * overrun:.4g} % more"
            f" deflection, {'below' if little else 'at least'} {100.0 * OVERRUN:g} %"
        )
        severity = "warning" if little else "ok"
    end = Extreme(overrun, highest.place)
    return (placed("spring-closure", sentence, end, "", OVERRUN, severity),)


def _buckling(helical: HelicalSpring) -> Finding:
    free, stable = helical.free_length, helical.stable_length
    severity: Severity
    if free < stable:
        end, severity = f"below {stable:.6g} mm: it cannot buckle", "ok"
    else:
        end = f"not below {stable:.6g} mm: it may buckle unless it is guided"
        severity = "warning"
    return Finding(
        "spring-buckling",
        severity,
        f"free length of the spring {free:.6g} mm, {end}",
        free,
        stable,
        "mm",
    )
