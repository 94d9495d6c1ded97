"""What carries the follower: a flank, one of two flanks of a groove, or one of two discs.

The normal force N is positive where the inner flank of the disc carries. On the other side, where
it is negative, the outer flank of a groove does, or the inner one of the return disc of a conjugate
pair. A side is told by that sign, +1 or -1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

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
