"""What touches the cam and carries the follower: flanks, discs, and a flat face that slides.

The normal force N is positive where the inner flank of the disc carries. On the other side, where
it is negative, the outer flank of a groove does, or the inner one of the return disc of a conjugate
pair. A side is told by that sign, +1 or -1.

A flat face slides on the cam. With the names of `camgeo.mechanism.face`: the cam goes round with
sigma, the follower with Omega = nu', the rate of its own direction, both counter-clockwise per unit
of cam speed. The contact lies h n from the cam axis, and f n from the pivot of a rocker, beside
what lies along the face. Along the face, in the sense t = Z'/|Z'| in which the contact runs along
the outline, the material of the face goes past that of the cam with

    g = h - sigma f Omega,

since a point of the cam has -h there along t, and one of the face -sigma f Omega (velocities of
rigid bodies). In a guide g = h: the rate at which the contact wanders along the face is no
sliding. A face that slides so is pressed on the cam by the whole normal force, in rests too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.errors import EffectError

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.motion.motion import Side
    from camgeo.numeric.arrays import FloatArray

INNER: Final = 1
OUTER: Final = -1

FLANKS: Final = {INNER: "inner", OUTER: "outer"}

OF_GROOVE: Final = (FLANKS, "flank")
OF_PAIR: Final = ({INNER: "main", OUTER: "return"}, "disc")


def holds_both_ways(subject: Subject) -> bool:
    """Whether the follower is held in both senses: in a groove, between two discs, by a yoke."""
    return (
        subject.cam.contact.closed_by_form
        or subject.returning is not None
        or subject.cam.yoke is not None
    )


def carrier(subject: Subject, sense: int) -> tuple[Subject, int]:
    """The disc that carries on the side `sense`, and which of its flanks: +1 inner, -1 outer."""
    other = subject.returning
    return (subject, sense) if other is None or sense == INNER else (other, INNER)


def leverage_of(subject: Subject, phi: FloatArray, side: Side, sense: int) -> FloatArray:
    """(n,) force on q [1 or mm/rad] per unit of |N| on the side `sense`, without friction.

    GeometryError where the pitch curve has a cusp.
    """
    disc, flank = carrier(subject, sense)
    return flank * disc.cam.disc.pitch_curve.leverage(phi, side)


def sides_of(subject: Subject) -> tuple[dict[int, str], str]:
    """The names of both sides, and of what they are: a flank or a disc."""
    return OF_GROOVE if subject.returning is None else OF_PAIR


def sliding(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) g [mm/rad] of the face on the cam at `phi` (n,) [rad], see the module.

    Per unit of cam speed: times omega it is in mm/s. For flat-faced followers.
    """
    jet = subject.drive.motion.jet(phi, side)
    return subject.cam.follower.sliding(jet, subject.cam.rotation)


def require_convex(subject: Subject, what: str) -> None:
    """Raise EffectError that there is no `what`, if a flat face cannot touch the cam all round."""
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
