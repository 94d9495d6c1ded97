"""Generalised forces on the follower over the cam angle.

The follower has one coordinate q: its lift [mm], or the angle of the rocker [rad]. A generalised
force Q does the work Q dq: it is in N for a translating follower, in N mm for an oscillating one,
and positive in the direction of increasing q.

Every force here is a polynomial in the speed of the cam at a given cam angle phi,

    Q = c0(phi) + c1(phi) omega + c2(phi) omega^2 + c3(phi) alpha,

with omega = dphi/dt [rad/s] and alpha = d omega/dt [rad/s^2]: weights and springs are c0, viscous
friction is c1, inertia is c2 and c3. The force is thus known for all speeds at once, except one
that is `present`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.numeric.arrays import FloatArray, Side, merged

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject

Scalar = TypeVar("Scalar", np.float64, np.complex128)

Coefficients = Callable[[FloatArray, Side], FloatArray]
"""(4, n) c0 to c3 at n cam angles [rad]."""

Off = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""(n,) the force at n cam angles [rad] on a follower with the coordinate q (n,) [mm or rad] and the
velocity dq/dt (n,) [per s], whatever the motion of the state is there."""


@dataclass(frozen=True, slots=True, eq=False)
class Force:
    """A generalised force.

    Attributes
    ----------
    name : e.g. "spring".
    coefficients : (4, n) c0 [N or N mm] to c3.
    potential : (n,) potential energy [N mm] of c0 at n cam angles, if it has one: c0 q' = -dV/dphi.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the formula of a coefficient changes, besides
        the borders of the motion.
    far : the part that acts on the far member of a linkage, as the generalised force on the
        demanded coordinate x [N or N mm]: a share far dx/dq of the `coefficients`; None if nothing
        of it does.
    off : the force on a follower that is off the cam, see `Off`; None if it is known for the motion
        of the state alone, and for inertia, which is no force on a free follower.
    cuts : (k,) cam angles [rad] in [0, 2 pi] between which extremes are searched for, besides the
        borders, where a coefficient has many of them.
    present : whether it is known for the present course of the cam in time only, and is then c0.
    """

    name: str
    coefficients: Coefficients
    potential: Callable[[FloatArray, Side], FloatArray] | None = None
    borders: FloatArray = field(default_factory=lambda: np.empty(0))
    off: Off | None = None
    far: Coefficients | None = None
    cuts: FloatArray = field(default_factory=lambda: np.empty(0))
    present: bool = False


def unmoved(values: Callable[[FloatArray, Side], FloatArray]) -> Coefficients:
    """The coefficients of a force (n,) that does not depend on speed: c0 alone."""

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = np.zeros((4, len(phi)))
        out[0] = values(phi, side)
        return out

    return coefficients


def rates_of(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(2 or more, n) omega [rad/s] and alpha [rad/s^2] of the scene; 0 if it gives no speed."""
    course = subject.state.course
    return np.zeros((2, len(phi))) if course is None else course.rates(phi, side)


def acceleration(jet: NDArray[Scalar]) -> NDArray[Scalar]:
    """(4, n) coefficients of d^2 x/dt^2 = x'' omega^2 + x' alpha (VDI 2143-1, eq. 2), from x' and
    x'' (2, n).
    """
    still = np.zeros_like(jet[0])
    return np.stack((still, still, jet[1], jet[0]))


def at_rates(coefficients: NDArray[Scalar], rates: FloatArray) -> NDArray[Scalar]:
    """(..., n) the force with `coefficients` (4, ..., n) at `rates` (2 or more, n): omega and
    alpha.
    """
    omega, alpha = rates[0], rates[1]
    c0, c1, c2, c3 = coefficients
    return np.asarray(c0 + omega * (c1 + omega * c2) + alpha * c3)


def total(forces: Sequence[Force], phi: FloatArray, side: Side) -> FloatArray:
    """(4, n) sum of the coefficients of `forces` at `phi` (n,) [rad]."""
    out = np.zeros((4, len(phi)))
    for force in forces:
        out += force.coefficients(phi, side)
    return out


def smooth_edges(smooth: FloatArray, forces: Sequence[Force]) -> FloatArray:
    """(k,) the smooth angles of the motion, `smooth`, borders and cuts of all `forces` [rad]."""
    cuts = [force.cuts for force in forces]
    return merged(np.concatenate((smooth, all_borders(forces), *cuts)))


def all_borders(forces: Sequence[Force]) -> FloatArray:
    """(k,) the borders of all `forces` [rad]."""
    return np.concatenate([force.borders for force in forces] or [np.empty(0)])
