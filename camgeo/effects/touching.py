"""The contact between follower and cam: which flank or disc carries, and how a flat face slides.

The normal force N is positive where the inner flank of the disc carries. Where it is negative, the
outer flank of a groove carries, or the inner flank of the return disc of a conjugate pair. These
two sides are numbered by this sign, +1 and -1.

A flat face slides on the cam. In the notation of `camgeo.mechanism.face`, the cam turns at sigma
and the follower at Omega = nu', the rate of its own direction, both counter-clockwise positive and
per unit of cam speed. In the direction of n, the contact is at the distance h from the cam axis,
and f from the pivot of a rocker. Along the face, in the direction t = Z'/|Z'| in which the contact
moves along the outline, the face slides relative to the cam at

    g = h - sigma f Omega,

because the velocities along t at the contact are -h for the cam and -sigma f Omega for the face
(rigid bodies). In a guide g = h: the motion of the contact along the face is not sliding. A sliding
face is pressed on the cam by the whole normal force, during dwells too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.errors import EffectError

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.numeric.arrays import FloatArray, Side

INNER: Final = 1
OUTER: Final = -1

FLANKS: Final = {INNER: "inner", OUTER: "outer"}

OF_GROOVE: Final = (FLANKS, "flank")
OF_PAIR: Final = ({INNER: "main", OUTER: "return"}, "disc")


def holds_both_ways(subject: Subject) -> bool:
    """Whether the follower is held in both directions: in a groove, between two discs, by a
    yoke.
    """
    return (
        subject.cam.contact.closed_by_form
        or subject.returning is not None
        or subject.cam.yoke is not None
    )


def carrier(subject: Subject, sense: int) -> tuple[Subject, int]:
    """The disc that carries on the side `sense`, and its flank: +1 inner, -1 outer."""
    other = subject.returning
    return (subject, sense) if other is None or sense == INNER else (other, INNER)


def leverage_of(subject: Subject, phi: FloatArray, side: Side, sense: int) -> FloatArray:
    """(n,) force on q [1 or mm/rad] per unit of |N| on the side `sense`, without friction.

    GeometryError where the pitch curve has a cusp.
    """
    disc, flank = carrier(subject, sense)
    return flank * disc.cam.disc.pitch_curve.leverage(phi, side)


def sides_of(subject: Subject) -> tuple[dict[int, str], str]:
    """The names of the two sides, and whether they are flanks or discs."""
    return OF_GROOVE if subject.returning is None else OF_PAIR


def sliding(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) sliding g [mm/rad] of a flat face on the cam at `phi` (n,) [rad], see the module.

    It is per unit of cam speed: multiplied by omega it is in mm/s.
    """
    jet = subject.drive.motion.jet(phi, side)
    return subject.cam.follower.sliding(jet, subject.cam.rotation)


def require_convex(subject: Subject, what: str) -> None:
    """Raise EffectError, that there is no `what`, if a flat face cannot touch the whole cam."""
    if subject.cam.follower.has_pitch_curve:
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
