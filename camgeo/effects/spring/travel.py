"""The travel of a spring over the cam angle.

A `Travel` gives x (n,), how far the spring has relaxed since cam angle 0 [mm or rad], and dx/dq,
its derivative by the follower's coordinate q. The effect of any kind of spring follows from these
two: a linear spring with preload P and rate k pushes or pulls along x with

    F = P - k x,      Q = F dx/dq,      V = k x^2 / 2 - P x,

the generalised force by virtual work, V the potential energy with V = 0 at cam angle 0 (Hooke's
law; Norton, Cam Design and Manufacturing Handbook, chapters on modelling and on the dynamics of
force-closed cams, where the preload closes the contact and the rate adds to it with the lift).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from camgeo.effects.wording import at, degrees
from camgeo.errors import GeometryError
from camgeo.mechanism.positions import locked_at
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes, piecewise_lowest

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.mechanism.slider_crank import SliderCrank
    from camgeo.motion.motion import Motion


class Travel(Protocol):
    """x (n,) [mm or rad] and dx/dq (n,) at n cam angles, see the module."""

    def __call__(self, phi: FloatArray, side: Side, /) -> tuple[FloatArray, FloatArray]: ...

    def at(self, place: FloatArray, /) -> tuple[FloatArray, FloatArray]:
        """The same with the member that moves the spring at `place` (n,) [mm or rad]."""

    @property
    def line(self) -> Callable[[FloatArray, Side], ComplexArray] | None:
        """(n,) unit vectors in the drawing along which a force above 0 acts on the follower; None
        if it is a torque, or acts on a slider.
        """

    @property
    def per_stroke(self) -> float:
        """dx/ds, s the stroke of the slider that the spring acts on; 0 if it acts on the
        follower.
        """


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
    along: FloatArray = follower.reach * relative.u
    return along


@dataclass(frozen=True, slots=True)
class Along:
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
        return self.at(self.motion.jet(phi, side, 1)[0])

    def at(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """x (n,) and dx/dq (n,) at the value `place` (n,) of the motion."""
        rate = np.ones(len(place)) if self.linkage is None else self.linkage.per_follower(place)
        return self.sense * (place - self.start), self.sense * rate


@dataclass(frozen=True, slots=True)
class BetweenPoints:
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
        return self.at(self.motion.jet(phi, side, 1)[0])

    def at(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """x (n,) and dx/dq (n,) with the rocker at q = `place` (n,) [rad]."""
        half = self._half(place)
        lever = self.anchor.conjugate() * self.attachment
        turned = lever * np.exp(2j * half)
        # r - r_0 = r_0 exp(i half) 2 i sin(half)
        gain = 4.0 * np.sin(half) * (lever * np.exp(1j * half)).imag
        before = abs(self.attachment - self.anchor)
        after = np.abs(self._ahead(half))
        rate = self.swing_sense * turned.imag / after
        return self.sense * gain / (after + before), self.sense * rate

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


def along_guide(subject: Subject) -> Along:
    """Along the guide of a translating follower; it relaxes towards the flank in use."""
    sense = closing_sense(subject) * subject.cam.follower.reach
    way = subject.cam.follower.way
    return Along(subject.state.motion, _start(subject.drive.motion), sense, way=way)


def about_pivot(subject: Subject) -> Along:
    """About the pivot of a rocker; it relaxes as the follower turns towards the flank in use.

    The direction is that at cam angle 0, which changes only if the arm passes the line of centres.
    """
    lever = float(outward(subject, np.zeros(1), "right")[0])
    sense = closing_sense(subject) * float(np.sign(lever))
    return Along(subject.state.motion, _start(subject.drive.motion), sense)


def along_slider(subject: Subject, linkage: SliderCrank) -> Along:
    """Along the slider's guide; it relaxes as the follower moves towards the flank in use.

    Raises
    ------
    GeometryError
        With key "effects.spring", if the direction of the slider that closes the contact changes
        over the turn: where the coupler is square to the guide, or the arm is on the line of
        centres.
    """
    stroke = subject.state.output
    locked = locked_at(linkage, stroke)
    if locked is not None:
        raise GeometryError(
            f"the slider cannot close the contact over the whole turn: {at(locked[0])} the coupler"
            " is square to the guide",
            key="effects.spring",
        )
    # It has the sign of dn/ds: ds/dpsi may vanish at a dead centre, but never changes sign.
    found = piecewise_extremes(partial(outward, subject), subject.state.smooth_angles)
    if found.lowest.value < 0.0 < found.highest.value:
        raise GeometryError(
            f"the slider closes the contact by moving one way {at(found.lowest.place)} and the"
            f" other way at {degrees(found.highest.place)}: the arm passes the line of centres",
            key="effects.spring",
        )
    outwards = 1.0 if found.highest.value > 0.0 else -1.0
    low = np.concatenate((np.zeros(1), subject.state.smooth_angles))
    slopes = linkage.per_follower(stroke.jet(low, "right", 1)[0])
    slope = float(slopes[np.argmax(np.abs(slopes))])
    sense = closing_sense(subject) * outwards * float(np.sign(slope))
    return Along(stroke, _start(subject.drive.plan), sense, linkage)


def between_points(
    subject: Subject,
    pivot: complex,
    anchor: complex,
    attachment: complex,
    sense: float,
) -> BetweenPoints:
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
    way = BetweenPoints(subject.state.motion, start, swing, lever, fixed, sense)
    shortest = piecewise_lowest(way.length, subject.state.smooth_angles)
    if shortest.value <= SHORTEST * (abs(lever) + abs(fixed)):
        raise GeometryError(
            f"is {shortest.value:.3g} mm from the attachment {at(shortest.place)}: the spring has"
            " no direction there",
            key="effects.spring.anchor",
        )
    return way


def _start(motion: Motion) -> float:
    return float(motion.jet(np.zeros(1), "right", 1)[0, 0])
