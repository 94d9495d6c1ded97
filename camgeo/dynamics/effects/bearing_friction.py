"""Coulomb friction in the pivot or the guide of a follower, under its whole load.

With the friction of roller or face, the contact provides the generalised force b |N|. The loads
L_i = A_i + B_i |N| that rub in the bearings, one in a pivot and one at each end of a guide (see
`camgeo.dynamics.effects.loads`), have a part A_i of their own, of inertia, springs and weights, and
a part by the contact. Friction takes lambda |L_i| against the motion of sense e, with lambda = mu d
/ 2 in a pivot and mu in a guide (Norton, Design of Machinery, chapter on dynamic force analysis,
and Volmer, Kurvengetriebe, on friction in the bearings of the follower). So with n = |N| and the
force R that is demanded of the contact,

    b n - w (|A_1 + B_1 n| + ...) = R,        w = e lambda.

With R_0 = R + w sum |A_i|, which is what friction and demand leave to the contact before it
carries, the flank must push in the direction u of R_0. With u on both sides,

    h(n) = u b n - u w sum (|A_i + B_i n| - |A_i|) = |R_0|.

h is 0 at n = 0, concave where u w > 0, convex where u w < 0, and at last grows with the slope
kappa = u b - u w sum |B_i|. If kappa > 0, there is exactly one root n >= 0: a concave h then grows
everywhere by at least kappa; a convex one is below |R_0| at 0 and leaves it once. Otherwise a force
that is large enough holds itself by the friction that it causes, and the follower jams. During a
dwell e = 0: friction is locked, does no work, and takes nothing.

For a single load the equation is a quadratic in n, of which the root with u b n - |R_0| + ... > 0
is the one. It is found for any number of loads alike, by the directions d_i of the loads: with
these given, |L_i| = Re(conj(d_i) L_i), the balance is linear,

    n = (R + w sum Re(conj(d_i) A_i)) / (b - w sum Re(conj(d_i) B_i)),

and nothing cancels that is not a difference of forces. Repeated with the directions at that n, from
the directions of the B_i on, this is Newton's method on h from the side on which it is monotone: it
converges from below where h is concave, from above where it is convex, and ends after as many steps
as there are ends where loads are collinear. Since d|L| = Re(conj(d) dL), the linear law also has
the derivatives of the solution.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.dynamics.effects.forces import Force, at_rates
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, Side

Scalar = TypeVar("Scalar", np.float64, np.complex128, np.bool_)

LINEAR: Final = 6
"""Rows of a linear law of the drive torque, see `camgeo.dynamics.effects.results.DriveTorque`."""

FIXED: Final = 9
"""Rows of a law with friction before those of its loads."""

PER_LOAD: Final = 12
"""Rows of each load."""

MOST_STEPS: Final = 100
"""Largest number of Newton steps; each ends with the first that rounding turns back."""


class StuckError(ArithmeticError):
    """No acceleration satisfies the equation of motion: friction jams or locks the follower."""


@dataclass(frozen=True, slots=True, eq=False)
class Rubbing:
    """Coulomb friction in the pivot or guide, per unit of its loads.

    Attributes
    ----------
    lever : friction on q per unit of load [mm in a pivot, 1 in a guide], above 0.
    senses : (n,) sense of the motion, +1, -1, or 0 during a dwell.
    per_normal : (k, n) complex loads of the contact per unit of |N| on the side `sense`: the force
        of the pivot in the drawing, or the forces of near and far end to the right of the guide;
        see `camgeo.dynamics.effects.loads`.
    """

    lever: float
    senses: Callable[[FloatArray, Side], FloatArray]
    per_normal: Callable[[FloatArray, Side, int], ComplexArray]


@dataclass(frozen=True, slots=True, eq=False)
class BearingFriction:
    """The friction in the pivot or guide of a scene.

    Attributes
    ----------
    rubbing : that of the pivot or guide.
    noncontact_loads : (4, k, n) coefficients c0 to c3 of the A_i, see
        `camgeo.dynamics.effects.loads`.
    per_far : (k, n) A_i for one unit more of force on the far member of a linkage, along its
        motion; 0 without one.
    """

    rubbing: Rubbing
    noncontact_loads: Callable[[FloatArray, Side], ComplexArray]
    per_far: Callable[[FloatArray, Side], ComplexArray]

    def with_force(self, force: Force) -> BearingFriction:
        """The friction with one more `force`, which loads the bearings if it acts on the far member
        of a linkage.
        """
        if force.far is None:
            return self
        far = force.far

        def noncontact_loads(phi: FloatArray, side: Side) -> ComplexArray:
            passed = self.per_far(phi, side) * far(phi, side)[:, np.newaxis]
            return np.asarray(self.noncontact_loads(phi, side) + passed)

        return replace(self, noncontact_loads=noncontact_loads)

    def drag(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) w [1 or mm]."""
        return np.asarray(self.rubbing.lever * self.rubbing.senses(phi, side))

    def noncontact_friction(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        """(n,) w sum |A_i| at `rates` [N or N mm]."""
        sizes = np.abs(at_rates(self.noncontact_loads(phi, side), rates))
        return np.asarray(self.drag(phi, side) * np.sum(sizes, axis=0))

    def largest(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        """(n,) lambda times the sum of the magnitudes of all terms of the A_i [N or N mm]: the
        scale of their rounding.
        """
        sizes = at_rates(np.abs(self.noncontact_loads(phi, side)), np.abs(rates))
        return np.asarray(self.rubbing.lever * np.sum(sizes, axis=0))


def solve_balance(
    demand: FloatArray,
    free: FloatArray,
    drag: FloatArray,
    noncontact: ComplexArray,
    per_normal: ComplexArray,
) -> tuple[FloatArray, ComplexArray]:
    """n (...) and the directions d (k, ...), for R, b and w (...), A and B (k, ...).

    All of R, b and w are multiplied by u. The result means nothing where kappa is not above 0.
    """
    # Elsewhere the balance has no certain root, and the force stays 0.
    sound = jam_reserve(free, drag, per_normal) > 0.0
    # The directions at a very large |N|, from which the iteration is monotone.
    d = unit_vectors(per_normal, np.ones_like(per_normal))

    def solved(d: ComplexArray) -> FloatArray:
        carried = free - drag * _sum(d, per_normal)
        force = np.zeros_like(carried)
        np.divide(
            demand + drag * _sum(d, noncontact), carried, out=force, where=sound & (carried > 0.0)
        )
        return force

    n, moving = solved(d), sound & (drag != 0.0)
    for _ in range(MOST_STEPS):
        turned = unit_vectors(noncontact + per_normal * n, d)
        new = solved(turned)
        # n rises where drag is above 0, h being concave, and falls where it is below 0: a step the
        # other way is rounding.
        moving = moving & (drag * (new - n) > 0.0)
        if not np.any(moving):
            break
        n, d = np.where(moving, new, n), np.where(moving, turned, d)
    # The directions at n itself: those that n is solved from are off by the last step, which may be
    # as large as the root of rounding.
    return n, unit_vectors(noncontact + per_normal * n, d)


def jam_reserve(free: FloatArray, drag: FloatArray, per_normal: ComplexArray) -> FloatArray:
    """kappa (...), for u b, u w (...) and B (k, ...): the follower jams where it is not above 0."""
    return np.asarray(free - drag * np.sum(np.abs(per_normal), axis=0))


def _sum(d: ComplexArray, vectors: ComplexArray) -> FloatArray:
    """The sum of Re(conj(d_i) vectors_i)."""
    return np.asarray(np.sum(d.real * vectors.real + d.imag * vectors.imag, axis=0))


def unit_vectors(vectors: ComplexArray, otherwise: ComplexArray) -> ComplexArray:
    """`vectors` over their sizes, `otherwise` where these are 0, or too small to be divided by."""
    size = np.abs(vectors)
    zero = size < np.finfo(np.float64).tiny
    return np.where(zero, otherwise, vectors / np.where(zero, 1.0, size))


@dataclass(frozen=True, slots=True, eq=False)
class RubbingLaw:
    """The drive torque with friction in the bearings, at given cam angles, for all speeds.

    The first of two is for an R_0 >= 0, the second for one below 0.

    Attributes
    ----------
    demand : (4, ...) c0 to c3 of R.
    torque : (2, ...) on the cam per unit of |N| [mm].
    free : (2, ...) b [1 or mm].
    drag : (...) w.
    noncontact_loads : (4, k, ...) c0 to c3 of the A_i.
    per_normal : (2, k, ...) B_i.
    """

    demand: FloatArray
    torque: FloatArray
    free: FloatArray
    drag: FloatArray
    noncontact_loads: ComplexArray
    per_normal: ComplexArray

    @classmethod
    def from_rows(cls, rows: FloatArray) -> Self:
        """The law of its `rows` (9 + 12 k, ...)."""
        shape = rows.shape[1:]
        count = (len(rows) - FIXED) // PER_LOAD
        # Complex loads are kept as real rows: all real parts first, then all imaginary ones.
        noncontact = rows[FIXED : FIXED + 8 * count].reshape(2, 4, count, *shape)
        per = rows[FIXED + 8 * count :].reshape(2, 2, count, *shape)
        return cls(
            rows[:4],
            rows[4:6],
            rows[6:8],
            rows[8],
            noncontact[0] + 1j * noncontact[1],
            per[0] + 1j * per[1],
        )

    @property
    def rows(self) -> FloatArray:
        """(9 + 12 k, ...), as they are kept."""
        shape = self.drag.shape
        count = self.noncontact_loads.shape[1]
        parts = [
            np.stack((loads.real, loads.imag)).reshape(2 * len(loads) * count, *shape)
            for loads in (self.noncontact_loads, self.per_normal)
        ]
        fixed = (self.demand, self.torque, self.free, self.drag[np.newaxis])
        return np.concatenate((*fixed, *parts))

    @property
    def jams(self) -> BoolArray:
        """(2, ...) whether a large force on the flank for this sign of R_0 jams the follower."""
        return np.stack(
            [
                jam_reserve(u * self.free[k], u * self.drag, self.per_normal[k]) <= 0.0
                for k, u in enumerate((1.0, -1.0))
            ]
        )

    @property
    def collinear(self) -> bool:
        """Whether each load has a fixed line, as those on a guide have."""
        return not (np.any(self.per_normal.imag) or np.any(self.noncontact_loads.imag))

    def released(self, omega: FloatArray | float, alpha: FloatArray | float) -> FloatArray:
        """(...) R_0 at the speed `omega` [rad/s] and acceleration `alpha` [rad/s^2]."""
        rates = self._rates(omega, alpha)
        alone = np.sum(np.abs(at_rates(self.noncontact_loads, rates)), axis=0)
        return np.asarray(at_rates(self.demand, rates) + self.drag * alone)

    def solved(
        self,
        omega: FloatArray | float,
        alpha: FloatArray | float,
        slowing: float = 0.0,
    ) -> tuple[IntArray, FloatArray, ComplexArray]:
        """Index (...) of the flank that carries, n (...) and the directions (k, ...).

        The cam turns at `omega` [rad/s] and at `alpha` - `slowing` T [rad/s^2], T the torque that
        it takes: a motor is slowed down by the contact, and the balance in n remains of the form in
        the module.
        """
        rates = self._rates(omega, alpha)
        # R_0 >= 0 is carried by the flank of index 0, with u = +1.
        index = np.where(self.released(omega, alpha) >= 0.0, 0, 1)
        u = 1.0 - 2.0 * index
        # The torque slows the cam down: alpha falls by this per unit of |N|, so each c3 adds to the
        # part that goes with |N|.
        slowed = _select(self.torque, index) * slowing
        free = _select(self.free, index) + self.demand[3] * slowed
        per = _select(self.per_normal, index) - self.noncontact_loads[3] * slowed
        demand = at_rates(self.demand, rates)
        n, d = solve_balance(
            u * demand, u * free, u * self.drag, at_rates(self.noncontact_loads, rates), per
        )
        sound = jam_reserve(u * free, u * self.drag, per) > 0.0
        return index, np.where(sound, n, np.nan), d

    def loads(
        self, omega: FloatArray | float, alpha: FloatArray | float, slowing: float = 0.0
    ) -> ComplexArray:
        """(k, ...) the loads, as for `solved`."""
        index, n, _ = self.solved(omega, alpha, slowing)
        less = slowing * n * _select(self.torque, index)
        noncontact = at_rates(self.noncontact_loads, self._rates(omega, alpha - less))
        return np.asarray(noncontact + _select(self.per_normal, index) * n)

    def linear(
        self, omega: FloatArray | float, alpha: FloatArray | float, slowing: float = 0.0
    ) -> FloatArray:
        """(6, ...) the linear law with the directions at `solved`; nan where the follower jams."""
        index, n, d = self.solved(omega, alpha, slowing)
        projections = np.stack([_sum(d, coefficients) for coefficients in self.noncontact_loads])
        free, torque = _select(self.free, index), _select(self.torque, index)
        jams = _select(self.jams, index) | np.isnan(n)
        carried = free - self.drag * _sum(d, _select(self.per_normal, index))
        # nan marks a follower that jams, and also avoids a division by 0.
        gain = np.where(jams, np.nan, torque / np.where(carried == 0.0, np.nan, carried))
        return np.concatenate(
            (self.demand + self.drag * projections, gain[np.newaxis], gain[np.newaxis])
        )

    def _rates(self, omega: FloatArray | float, alpha: FloatArray | float) -> FloatArray:
        shape = np.zeros(self.drag.shape)
        return np.stack((omega + shape, alpha + shape))


def _select(pair: NDArray[Scalar], index: IntArray) -> NDArray[Scalar]:
    """The first of the `pair` (2, ...) where `index` is 0, the second one where it is 1."""
    return np.asarray(np.where(index == 0, pair[0], pair[1]))


def add_force(
    rows: FloatArray,
    bearings: BearingFriction | None,
    force: Force,
    phi: FloatArray,
    side: Side,
) -> FloatArray:
    """The law `rows` (r, n) at `phi` (n,) [rad] with one more `force`; without `bearings` it is
    linear.
    """
    rows[:4] -= force.coefficients(phi, side)
    if bearings is None or force.far is None:
        return rows
    law = RubbingLaw.from_rows(rows)
    law.noncontact_loads[:] += bearings.per_far(phi, side) * force.far(phi, side)[:, np.newaxis]
    return law.rows


def linear_law(
    rows: FloatArray, omega: FloatArray | float, alpha: FloatArray | float, slowing: float = 0.0
) -> FloatArray:
    """(6, ...) the law at these rates, see `RubbingLaw.linear`; `rows` if they are linear."""
    if len(rows) == LINEAR:
        return rows
    return RubbingLaw.from_rows(rows).linear(omega, alpha, slowing)


def scalar_linear_law(law: list[float], omega: float, alpha: float, slowing: float) -> list[float]:
    """`RubbingLaw.linear` at one cam angle, with Python's numbers, which takes less time than
    arrays. Raises StuckError where the follower jams.
    """
    count = (len(law) - FIXED) // PER_LOAD
    # In the order of `RubbingLaw.rows`: the real parts of all A_i, then their imaginary parts.
    real, imag = FIXED, FIXED + 4 * count
    noncontact = [
        [complex(law[real + k * count + i], law[imag + k * count + i]) for k in range(4)]
        for i in range(count)
    ]
    demand = law[0] + omega * (law[1] + omega * law[2]) + alpha * law[3]
    loads = [a[0] + omega * (a[1] + omega * a[2]) + alpha * a[3] for a in noncontact]
    flank = 0 if demand + law[8] * sum(map(abs, loads)) >= 0.0 else 1
    u = 1.0 - 2.0 * flank
    torque, free, drag = law[4 + flank], u * law[6 + flank], u * law[8]
    real = FIXED + 8 * count + flank * count
    per = [complex(law[real + i], law[real + 2 * count + i]) for i in range(count)]
    slowed = [b - a[3] * torque * slowing for a, b in zip(noncontact, per, strict=True)]
    moved = free + u * law[3] * torque * slowing
    least = min(free - drag * sum(map(abs, per)), moved - drag * sum(map(abs, slowed)))
    if not least > 0.0:
        raise StuckError
    # Any first step counts as one in the direction in which the iteration is monotone.
    n, d = -math.inf if drag > 0.0 else math.inf, [_unit(b, 1.0) for b in slowed]
    for _ in range(MOST_STEPS):
        share = sum((e.conjugate() * a).real for e, a in zip(d, loads, strict=True))
        carried = moved - drag * sum(
            (e.conjugate() * b).real for e, b in zip(d, slowed, strict=True)
        )
        new = (u * demand + drag * share) / carried
        if not drag * (new - n) > 0.0:
            break
        n = new
        d = [_unit(a + b * n, e) for a, b, e in zip(loads, slowed, d, strict=True)]
    shares = [
        sum((e.conjugate() * a[k]).real for e, a in zip(d, noncontact, strict=True))
        for k in range(4)
    ]
    carried = law[6 + flank] - law[8] * sum(
        (e.conjugate() * b).real for e, b in zip(d, per, strict=True)
    )
    gain = torque / carried
    return [*(c + law[8] * share for c, share in zip(law[:4], shares, strict=True)), gain, gain]


def _unit(vector: complex, otherwise: complex) -> complex:
    return vector / abs(vector) if vector else otherwise
