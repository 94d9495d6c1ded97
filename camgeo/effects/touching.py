"""The contact between follower and cam: which side carries, where it is lost, how a face slides.

The normal force N is positive where the inner flank of the disc carries. Where it is negative, the
outer flank of a groove carries, or the inner flank of the return disc of a conjugate pair, or the
disc at the second side of a yoke. These two sides are numbered by this sign, +1 and -1.

A flat face slides on the cam. In the notation of `camgeo.mechanism.face`, the cam turns at sigma
and the follower at Omega = nu', the rate of its own direction, both counter-clockwise positive and
per unit of cam speed. In the direction of n, the contact is at the distance h from the cam axis,
and f from the pivot of a rocker. Along the face, in the direction t = Z'/|Z'| in which the contact
moves along the outline, the face slides relative to the cam at

    g = h - sigma f Omega,

because the velocities along t at the contact are -h for the cam and -sigma f Omega for the face
(rigid bodies). In a guide g = h: the motion of the contact along the face is not sliding. A sliding
face is pressed on the cam by the whole normal force, during dwells too.

Contact is lost where the only flank would have to pull, and where the velocity of a mass jumps away
from it. `lost_contact` is the definition of this for all effects.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from camgeo.effects.immovable import shocks
from camgeo.effects.lost_contact import LostContact, Range
from camgeo.effects.ranges import ranges_below
from camgeo.effects.results import Bearing
from camgeo.errors import EffectError
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.state.state import FIRST, SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from camgeo.effects.effect import Quantity, Result, Subject
    from camgeo.effects.results import ContactForce
    from camgeo.numeric.arrays import FloatArray, Number, Side

Answer = TypeVar("Answer", bound="Result")

INNER: Final = FIRST
OUTER: Final = SECOND

FLANKS: Final = {INNER: "inner", OUTER: "outer"}

TOUCH: Final = 1e-12
"""A contact force below this share of the largest one of the turn is 0."""

OF_GROOVE: Final = (FLANKS, "flank")
OF_PAIR: Final = ({INNER: "main", OUTER: "return"}, "disc")
OF_YOKE: Final = ({INNER: "main", OUTER: "opposite"}, "side")


def holds_both_ways(subject: Subject) -> bool:
    """Whether the follower is held in both directions: in a groove, between two discs, by a
    yoke.
    """
    return subject.cam.contact.closed_by_form or subject.returning is not None


def carrier(subject: Subject, sense: int) -> tuple[Subject, int]:
    """The disc that carries on the side `sense`, and its flank: +1 inner, -1 outer.

    Its follower is the one of that side; of a yoke it is the same disc.
    """
    other = subject.returning
    return (subject, sense) if other is None or sense == INNER else (other, INNER)


def on_carrier(normal: FloatArray, of: Callable[[int], NDArray[Number]]) -> NDArray[Number]:
    """(..., n) the values `of` the side that carries the contact force `normal` (n,)."""
    inner, outer = of(INNER), of(OUTER)
    return np.where(normal >= 0.0, inner, outer)


def lost_contact(
    subject: Subject,
    normal: Quantity,
    extremes: Extremes,
    edges: FloatArray,
    mass: Quantity | None,
    margin: float = 0.0,
) -> LostContact:
    """Where less than `margin` [N] presses the follower on the flank that makes its motion.

    A follower that is held in both directions stays on that of a written contour only where this
    carries; the demanded motion is that of both sides, and nothing is lost.

    Parameters
    ----------
    normal : contact force [N], positive where the inner flank carries, smooth between neighbouring
        `edges` (k,) [rad] from 0 to 2 pi.
    extremes : of `normal`.
    mass : that a jump of the velocity strikes, reduced to the follower; None without any.
    """
    sense = subject.state.sense if holds_both_ways(subject) else subject.cam.contact.push
    if sense == 0:
        return LostContact()
    lowest, limit = lowest_on_flank(extremes, sense), margin - TOUCH * extremes.magnitude
    ranges: tuple[Range, ...] = ()
    if lowest.value < limit:
        ranges = ranges_below(lambda phi, side: sense * normal(phi, side), edges, limit, lowest)
    return LostContact(ranges, _leaps(subject, mass, sense))


def lowest_on_flank(extremes: Extremes, sense: int) -> Extreme:
    """The smallest force [N] on the flank `sense`, negative where it would have to pull."""
    if sense > 0:
        return extremes.lowest
    return Extreme(-extremes.highest.value, extremes.highest.place)


def _leaps(subject: Subject, mass: Quantity | None, sense: int) -> tuple[float, ...]:
    """Cam angles [rad] at which the velocity of a mass jumps away from the flank `sense`.

    No finite force holds the follower on the flank there.
    """
    motion, found = subject.state.motion, []
    for angle in shocks(subject, mass):
        here = np.array([angle])
        jump = motion.jet(here, "right")[1] - motion.jet(here, "left")[1]
        if jump[0] * leverage_of(subject, here, "right", sense)[0] < 0.0:
            found.append(angle)
    return tuple(found)


def outwards_of(subject: Subject, phi: FloatArray, side: Side, sense: int) -> FloatArray:
    """(n,) direction of q in which the flank `sense` of a single disc pushes, +1 or -1."""
    return sense * np.sign(subject.state.curve.leverage(phi, side))


def leverage_of(subject: Subject, phi: FloatArray, side: Side, sense: int) -> FloatArray:
    """(n,) force on q [1 or mm/rad] per unit of |N| on the side `sense`, without friction.

    GeometryError where the pitch curve has a cusp.
    """
    disc, flank = carrier(subject, sense)
    return flank * disc.state.curve.leverage(phi, side)


def bearing_of(contact: ContactForce, phi: FloatArray, side: Side) -> Bearing:
    """How friction shares the load at n cam angles, on the side that carries; 0 without any."""
    if contact.friction is None:
        return Bearing(*np.zeros((3, len(phi))))
    inner, outer = (contact.friction.bearing(phi, side, sense) for sense in (INNER, OUTER))
    on_inner = contact.normal(phi, side) >= 0.0
    return Bearing(
        np.where(on_inner, inner.tangential, outer.tangential),
        np.where(on_inner, inner.tilt, outer.tilt),
        np.where(on_inner, inner.overhang, outer.overhang),
    )


def sides_of(subject: Subject) -> tuple[dict[int, str], str]:
    """The names of the two sides, and whether they are flanks, discs or sides of a yoke."""
    if subject.returning is None:
        return OF_GROOVE
    return OF_PAIR if subject.paired else OF_YOKE


def with_other_side(subject: Subject, main: Answer, other: Result) -> Answer:
    """The result on the `main` side with findings, columns and errors of the `other` one besides,
    by their names.
    """
    names, noun = sides_of(subject)
    second = names[OUTER]
    told = [
        replace(each, name=f"{second}-{each.name}", sentence=f"{second} {noun}: {each.sentence}")
        for each in other.findings
    ]
    columns = [
        replace(column, name=f"{names[sense]} {column.name}")
        for sense, of in ((INNER, main), (OUTER, other))
        for column in of.columns
    ]
    errors = {f"{second}-{name}": bound for name, bound in other.errors.items()}
    return replace(
        main,
        findings=(*main.findings, *told),
        columns=tuple(columns),
        errors={**main.errors, **errors},
    )


def sliding(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) sliding g [mm/rad] of a flat face on the cam at `phi` (n,) [rad], see the module.

    It is per unit of cam speed: multiplied by omega it is in mm/s.
    """
    jet = subject.state.motion.jet(phi, side)
    return subject.cam.follower.sliding(jet, subject.cam.rotation)


def require_convex(subject: Subject, what: str) -> None:
    """Raise EffectError, that there is no `what`, if a flat face cannot touch the whole cam.

    One that has the motion of what is left of the disc touches that.
    """
    if subject.cam.follower.has_pitch_curve or subject.state.sense:
        return
    from camgeo.check.face import check_convexity  # few cams have a flat face

    for found in check_convexity(subject.cam.disc.pitch_curve):
        if found.severity == "no-disc":
            raise EffectError(
                f"there is no {what}: {found.sentence}",
                value=found.value,
                limit=found.limit,
                unit=found.unit,
                cam_angle=found.cam_angle,
            )
