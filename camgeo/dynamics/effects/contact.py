"""The contact between follower and cam: which side carries, where it is lost, how a face slides.

The normal force N is positive where the inner flank of the disc carries. Where it is negative, the
outer flank of a groove carries, or the inner flank of the return disc of a conjugate pair, or the
disc at the second side of a yoke. These two sides are numbered by this sign, +1 and -1.

A flat face slides on the cam. In the notation of `camgeo.kinematics.mechanism.flat`, the cam turns
at sigma and the follower at Omega = nu', the rate of its own direction, both counter-clockwise
positive and per unit of cam speed. In the direction of n, the contact is at the distance h from the
cam axis, and f from the pivot of a rocker. Along the face, in the direction t = Z'/|Z'| in which
the contact moves along the outline, the face slides relative to the cam at

    g = h - sigma f Omega,

because the velocities along t at the contact are -h for the cam and -sigma f Omega for the face
(rigid bodies). In a guide g = h: the motion of the contact along the face is not sliding. A sliding
face is pressed on the cam by the whole normal force, during dwells too.

Contact is lost where the only flank would have to pull, and where the velocity of a mass jumps away
from it. `lost_contact` is the definition of this for all effects.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from camgeo.dynamics.effects.effect import Quantity, Result, Subject
from camgeo.dynamics.effects.forces import shocks
from camgeo.dynamics.effects.results import Bearing, ContactForce, LostContact, LowRange
from camgeo.dynamics.state.state import FIRST, SECOND
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, Number, Side, merged
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_lowest, with_roots

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from camgeo.cam.cam import Cam
    from camgeo.dynamics.state.written import HasPart
    from camgeo.part.part import Part


Answer = TypeVar("Answer", bound="Result")

INNER: Final = FIRST
OUTER: Final = SECOND

FLANKS: Final = {INNER: "inner", OUTER: "outer"}

TOUCH: Final = 1e-12
"""A contact force below this share of the largest one of the turn is 0."""

GROOVE_SIDES: Final = (FLANKS, "flank")
PAIR_SIDES: Final = ({INNER: "main", OUTER: "return"}, "disc")
YOKE_SIDES: Final = ({INNER: "main", OUTER: "opposite"}, "side")


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


def select_carrier(normal: FloatArray, values: Callable[[int], NDArray[Number]]) -> NDArray[Number]:
    """(..., n) the `values` of the side that carries the contact force `normal` (n,)."""
    inner, outer = values(INNER), values(OUTER)
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
    # A force that is 0 but for rounding still touches.
    lowest, limit = lowest_on_flank(extremes, sense), margin - TOUCH * extremes.magnitude
    ranges: tuple[LowRange, ...] = ()
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
    motion, leaps = subject.state.motion, []
    for angle in shocks(subject, mass):
        here = np.array([angle])
        jump = motion.jet(here, "right")[1] - motion.jet(here, "left")[1]
        # A flank pushes in the direction of its leverage; to cause this jump it would have to pull.
        if jump[0] * contact_leverage(subject, here, "right", sense)[0] < 0.0:
            leaps.append(angle)
    return tuple(leaps)


def contact_leverage(subject: Subject, phi: FloatArray, side: Side, sense: int) -> FloatArray:
    """(n,) force on q [1 or mm/rad] per unit of |N| on the side `sense`, without friction.

    GeometryError where the pitch curve has a cusp.
    """
    disc, flank = carrier(subject, sense)
    return flank * disc.state.curve.leverage(phi, side)


def bearing_on_carrier(contact: ContactForce, phi: FloatArray, side: Side) -> Bearing:
    """The `Bearing` at n cam angles on the side that carries; all values are 0 without friction."""
    if contact.friction is None:
        return Bearing(*np.zeros((3, len(phi))))
    inner, outer = (contact.friction.bearing(phi, side, sense) for sense in (INNER, OUTER))
    on_inner = contact.normal(phi, side) >= 0.0
    return Bearing(
        np.where(on_inner, inner.tangential, outer.tangential),
        np.where(on_inner, inner.tilt, outer.tilt),
        np.where(on_inner, inner.overhang, outer.overhang),
    )


def side_names(subject: Subject) -> tuple[dict[int, str], str]:
    """The names of the two sides, and whether they are flanks, discs or sides of a yoke."""
    if subject.returning is None:
        return GROOVE_SIDES
    return PAIR_SIDES if subject.paired else YOKE_SIDES


def with_other_side(subject: Subject, main: Answer, other: Result) -> Answer:
    """The result on the `main` side with findings, columns and errors of the `other` one besides,
    by their names.
    """
    names, noun = side_names(subject)
    second = names[OUTER]
    other_findings = [
        replace(
            finding,
            name=f"{second}-{finding.name}",
            sentence=f"{second} {noun}: {finding.sentence}",
        )
        for finding in other.findings
    ]
    columns = [
        replace(column, name=f"{names[sense]} {column.name}")
        for sense, result in ((INNER, main), (OUTER, other))
        for column in result.columns
    ]
    errors = {f"{second}-{name}": bound for name, bound in other.errors.items()}
    return replace(
        main,
        findings=(*main.findings, *other_findings),
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
    from camgeo.check.disc import check_convexity  # few cams have a flat face

    for finding in check_convexity(subject.cam.disc.pitch_curve):
        if finding.severity == "no-disc":
            raise EffectError(
                f"there is no {what}: {finding.sentence}",
                value=finding.value,
                limit=finding.limit,
                unit=finding.unit,
                cam_angle=finding.cam_angle,
            )


# -- turning disc ---------------------------------------------------------------------------------
# The disc as a body that turns with the camshaft.


def require_part(subject: Subject, purpose: str) -> Part:
    """The part; EffectError, that there is no disc for the `purpose`, if it does not exist."""
    try:
        return subject.required_disc.part
    except GeometryError as error:
        if error.key:
            raise
        raise EffectError(f"there is no disc to {purpose}: {error.message}") from error


def unbalance_force(
    unbalance: complex, rotation: int, phi: FloatArray, rates: FloatArray
) -> ComplexArray:
    """(n,) [N] inertia force of an unbalance [t mm] on the shaft, in the axes of the frame.

    The centre of mass is at U/m exp(i sigma phi). Minus m times its second derivative is
    U exp(i sigma phi) (omega^2 - i sigma alpha): the centrifugal force U omega^2, and at
    varying speed the tangential one (Norton, "Machine Design", chapter on balancing, for the
    first; the second derivative gives both).
    """
    turned = unbalance * np.exp(1j * rotation * phi)
    return np.asarray(turned * (rates[0] ** 2 - 1j * rotation * rates[1]))


# -- yoke sides -----------------------------------------------------------------------------------
# A yoke in the effects: the disc twice, as its two sides touch it.
#
# The second side is handled as the return disc of a conjugate pair: `camgeo.cam.cam` has the
# follower that it is, and the curve on which that runs is the disc's own, half a turn on.


@dataclass(frozen=True)
class Opposite:
    """A disc as the second side of its yoke touches it; its cam is made on demand."""

    disc: HasPart

    @property
    def cam(self) -> Cam:
        """See `Cam.opposite`."""
        second = self.disc.cam.opposite
        assert second is not None  # it has a yoke
        return second

    @property
    def part(self) -> Part:
        """The part of the disc, which has both sides."""
        return self.disc.part


def with_both_yoke_sides(subject: Subject) -> Subject:
    """The `subject`, whose cam has a yoke, with the second side of the yoke as `returning`."""
    return replace(subject, returning=replace(subject, disc=Opposite(subject.required_disc)))


# -- ranges ---------------------------------------------------------------------------------------
# Ranges of the turn where a quantity is below a limit.


def ranges_below(
    quantity: Quantity, edges: FloatArray, limit: float, lowest: Extreme
) -> tuple[LowRange, ...]:
    """The ranges where `quantity` is below `limit`, by ascending start.

    Parameters
    ----------
    quantity : smooth between neighbouring `edges`.
    edges : (k,) [rad] from 0 to 2 pi.
    lowest : its smallest value; the range around it is found however short it is. Others are found
        if they are longer than 1/32 of a piece.
    """

    def above(phi: FloatArray) -> FloatArray:
        return quantity(phi, "right") - limit

    # The known minimum is made an edge, so that a short range around it is not stepped over.
    cuts = with_roots(above, merged(np.concatenate((edges, [lowest.place]))))
    below = above(0.5 * (cuts[:-1] + cuts[1:])) < 0.0
    ranges = []
    for pieces in runs(below):
        passing = pieces.index(0) if 0 in pieces else 0  # a run may pass the end of the turn
        halves = [half for half in (pieces[:passing], pieces[passing:]) if half]
        low = min(
            (piecewise_lowest(quantity, cuts[half[0] : half[-1] + 2]) for half in halves),
            key=lambda extreme: extreme.value,
        )
        ranges.append(LowRange(float(cuts[pieces[0]]), float(cuts[pieces[-1] + 1]), low))
    # The range is too short to be resolved: the place of its minimum stands for it.
    if not ranges and lowest.value < limit:
        ranges.append(LowRange(lowest.place, lowest.place, lowest))
    return tuple(ranges)


def runs(inside: BoolArray) -> list[list[int]]:
    """The pieces of a turn that are `inside` (n,), grouped into runs of neighbours.

    A run that passes the end of the turn counts as one, and comes last.
    """
    groups: list[list[int]] = []
    for piece in np.flatnonzero(inside):
        if groups and groups[-1][-1] == piece - 1:
            groups[-1].append(int(piece))
        else:
            groups.append([int(piece)])
    if len(groups) > 1 and inside[0] and inside[-1]:
        groups.append(groups.pop() + groups.pop(0))
    return groups
