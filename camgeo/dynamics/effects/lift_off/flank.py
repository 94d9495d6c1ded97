"""The flank on which the follower must stay, and the force that holds it there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.check.finding import DIGITS, rounded_beyond
from camgeo.dynamics.effects.bearing_friction import unit_vectors
from camgeo.dynamics.effects.contact import TOUCH, lowest_on_flank
from camgeo.dynamics.effects.effect import Quantity, Subject
from camgeo.dynamics.effects.forces import cam_rates, smooth_edges
from camgeo.dynamics.effects.results import ContactForce, Spring
from camgeo.dynamics.effects.wording import spring_scale
from camgeo.errors import EffectError
from camgeo.numeric.arrays import SHARE, ComplexArray, FloatArray, Side, read_only
from camgeo.numeric.extremes import (
    Extreme,
    piecewise_extremes,
    piecewise_highest,
    sample_grid,
    with_roots,
)
from camgeo.numeric.kept import Answers


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """Quantities at n cam angles that are the same at all speeds; read-only.

    Attributes
    ----------
    outwards : (n,) direction of q in which the flank pushes, +1 or -1.
    drag : (n,) w [1 or mm], see `camgeo.dynamics.effects.bearing_friction`, in the direction of the
        flank; 0 without friction in pivot or guide.
    loads : (3, k, n) coefficients l0, l1, l2 of the loads l0 + f l1 + f^2 l2 that rub in pivot or
        guide under the margin, with a rigid train; f as for `Flank.reserve`.
    needed, size : (3, n) the coefficients of `Flank.reserve` but for friction under the `loads`,
        and the sizes of their terms.
    per_far : (k, n) of the loads by one unit more of force on the far member of a linkage.
    """

    outwards: FloatArray
    drag: FloatArray
    loads: ComplexArray
    needed: FloatArray
    size: FloatArray
    per_far: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class Flank:
    """The single flank on which a roller or face must stay.

    Attributes
    ----------
    subject : the design.
    contact : the contact force.
    sense : +1 for the inner flank, -1 for the outer one.
    margin : contact force that must remain [N].
    """

    subject: Subject
    contact: ContactForce
    sense: int
    margin: float
    _recent: Answers[Known] = field(default_factory=Answers, init=False, repr=False)

    @property
    def toucher(self) -> str:
        """What touches the flank: "roller" or "face"."""
        return self.subject.cam.follower.touching

    def force(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N] force on the flank at the speed of the scene, negative where it would have to
        pull.
        """
        return self.sense * self.contact.normal(phi, side)

    @property
    def lowest(self) -> Extreme:
        """The smallest `force` of the turn."""
        return lowest_on_flank(self.contact.extremes, self.sense)

    @property
    def base_edges(self) -> FloatArray:
        """(k,) cam angles [rad] between which all but the force of an elastic train is smooth."""
        return smooth_edges(self.subject.state.smooth_angles, self.contact.lasting)

    def known(self, phi: FloatArray, side: Side) -> Known:
        """Computed once for recent requests: a search over the speed asks again and again."""
        return self._recent.recall(lambda: self._known(phi, side), side, phi)

    def _known(self, phi: FloatArray, side: Side) -> Known:
        outwards = self.sense * np.sign(self.subject.state.curve.leverage(phi, side))
        omega, alpha = cam_rates(self.subject, phi, side)[:2]
        needed, size = np.zeros((3, len(phi))), np.zeros((3, len(phi)))
        for force in self.contact.lasting:
            c0, c1, c2, c3 = force.coefficients(phi, side)
            # omega goes with f and alpha with f^2: the terms of f^0, f^1 and f^2.
            parts = np.stack((c0, c1 * omega, c2 * omega * omega + c3 * alpha))
            needed -= parts
            size += np.abs(parts)
        if self.margin:
            bracket = self.margin * self.contact.bracket(phi, side, self.sense)
            needed[0] -= bracket
            size[0] += np.abs(bracket)
        # In the direction in which the flank pushes, a lack is below 0.
        needed *= outwards
        drag, loads = np.zeros(len(phi)), np.zeros((3, 0, len(phi)), dtype=np.complex128)
        per_far, bearings = loads[0], self.contact.bearings
        if bearings is not None:
            drag, noncontact = (
                outwards * bearings.drag(phi, side),
                bearings.noncontact_loads(phi, side),
            )
            per_far = bearings.per_far(phi, side)
            per = bearings.rubbing.per_normal(phi, side, self.sense)
            loads = np.stack(
                (
                    noncontact[0] + self.margin * per,
                    noncontact[1] * omega,
                    noncontact[2] * omega * omega + noncontact[3] * alpha,
                )
            )
            # The bracket has the friction of the margin alone.
            needed[0] -= self.margin * drag * np.sum(np.abs(per), axis=0)
        return Known(
            outwards=read_only(outwards),
            drag=read_only(drag),
            loads=read_only(loads),
            needed=read_only(needed),
            size=read_only(size),
            per_far=read_only(per_far),
        )

    def passed(self, phi: FloatArray, side: Side, push: FloatArray) -> ComplexArray:
        """(k, n) of these loads by a force `push` (n,) on the far member of a linkage."""
        return np.asarray(self.known(phi, side).per_far * push)

    def left(self, phi: FloatArray, side: Side, more: ComplexArray | None = None) -> FloatArray:
        """(n,) the reserve at the speed of the scene, with the train of its state; for `more` see
        `reserve`.
        """
        passed, behind = self._train_loads(phi, side), self.contact.behind
        total = passed if more is None else passed + more
        reserve: FloatArray = np.sum(self.reserve(phi, side, more=total), axis=0)
        if behind is not None:
            reserve -= self.known(phi, side).outwards * behind.beyond_rigid(phi, side)
        return reserve

    def _train_loads(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(k, n) what the train of the state adds to the loads."""
        behind = self.contact.behind
        push = np.zeros(len(phi)) if behind is None else behind.beyond_base(phi, side)
        return self.passed(phi, side, push)

    def reserve(
        self,
        phi: FloatArray,
        side: Side,
        factor: float = 1.0,
        more: ComplexArray | None = None,
    ) -> FloatArray:
        """(3, n) r0, r1, r2 [N or N mm]: r0 + f r1 + f^2 r2 is the reserve over the margin.

        This is the generalised force of the contact, in the direction in which the flank pushes,
        minus that of the margin, with the cam running f times as fast as in the scene: omega is
        proportional to f, alpha to f^2. It has the sign of the contact force minus the margin. An
        elastic train counts as rigid.

        Friction in pivot or guide goes with the sizes of their loads, which are no polynomials: the
        loads have the directions that they have at f = `factor`, where value and derivative are
        exact. `more` (k, n) is added to the loads.
        """
        known = self.known(phi, side)
        loads, drag = known.loads, known.drag
        if more is not None:
            loads = np.concatenate((loads[:1] + more, loads[1:]))
        # The directions are those at one f; with them the sizes are polynomials.
        total = loads[0] + factor * (loads[1] + factor * loads[2])
        d = unit_vectors(total, np.ones_like(total))
        coefficients: FloatArray = known.needed + drag * np.sum((np.conj(d) * loads).real, axis=1)
        size = known.size + np.abs(drag) * np.sum(np.abs(loads), axis=1)
        coefficients[np.abs(coefficients) <= SHARE * size] = 0.0
        return coefficients

    def slope(
        self, phi: FloatArray, side: Side, more: ComplexArray, per_unit: ComplexArray
    ) -> FloatArray:
        """(n,) derivative of w sum |L| at the speed of the scene, with the train of its state, as
        the loads, which have `more` (k, n), go on by `per_unit` (k, n).
        """
        known = self.known(phi, side)
        load = np.sum(known.loads, axis=0) + self._train_loads(phi, side) + more
        d = unit_vectors(load, np.ones_like(load))
        return np.asarray(known.drag * np.sum((np.conj(d) * per_unit).real, axis=0))

    def lift_off_speed(self, edges: FloatArray) -> Extreme:
        """The smallest speed factor at which the force on the flank falls below its margin, with
        the cam angle [rad]; 0 if this happens at any speed, infinite if it never happens.

        Parameters
        ----------
        edges : (k,) cam angles [rad] from 0 to 2 pi between which the coefficients are smooth.
        """

        def static(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(self.reserve(phi, side, factor=0.0)[0])

        rest = piecewise_extremes(static, edges)
        if rest.lowest.value < -TOUCH * rest.magnitude:
            return Extreme(0.0, rest.lowest.place)

        if self.contact.bearings is None:
            return _speed(self, edges, 1.0)
        speed = _speed(self, edges, 1.0)
        # With other directions of the loads, at high speeds, it may leave the flank yet.
        if np.isinf(speed.value):
            speed = _speed(self, edges, FASTEST)
        ends = (0.0, math.inf)
        return _fixed_point(
            lambda factor: _speed(self, edges, factor), speed, ends, "lift-off speed"
        )

    def least_spring(self, spring: Spring, leaps: Sequence[float] = ()) -> tuple[Extreme, Extreme]:
        """Least preload and least stiffness, each with the other one unchanged, that keep contact;
        see `least_property`. At the cam angles `leaps` [rad], where the velocity jumps away, none
        does.
        """
        if leaps:
            # No finite force makes a mass follow a jump of its velocity.
            never = Extreme(math.inf, leaps[0])
            return never, never
        edges, loads = self.contact.edges, _pivot_loads(self, spring)
        return (
            least_property(self, spring.per_preload, spring.preload, edges, loads[0]),
            least_property(self, spring.per_stiffness, spring.stiffness, edges, loads[1]),
        )


# -- sizing ---------------------------------------------------------------------------------------
# The speed at which the roller first leaves its flank, and the spring that keeps it there.
#
# With the cam running f times as fast as in the scene, the contact force is a quadratic in f at
# every cam angle: weights and springs are constant, viscous friction is proportional to f, inertia
# to f^2. The lift-off speed is the smallest f at which the force falls to its margin anywhere (the
# "jump speed" of textbooks: Norton, Machine Design, chapter on cam design, follower jump; Rothbart,
# Cam Design Handbook, chapter on dynamics).
#
# The force on the flank is linear in preload and stiffness (Norton, Machine Design, chapter on cam
# design: spring rate and preload against follower jump): a times the preload, b times the
# stiffness, and the rest, each a function of cam angle. Where a is above 0, the preload must be at
# least the missing force divided by a. Where a is below 0, which is possible with a lever, it must
# not exceed this.
#
# Friction in pivot or guide adds the sizes of their loads, with which neither is a polynomial any
# more. With the directions of the loads given it is one, and has the value and the derivative of
# the whole at the speed, or at the spring, for which they are taken. So both are found again with
# the directions at the value found before, until it stays: Newton's method for the whole turn.


FASTEST: Final = 1e6
"""A factor of the speed at which inertia alone directs the loads."""

BOUNDLESS: Final = 1e200
"""Stands for division by 0: far above all quotients, with finite differences."""

MOST_STEPS: Final = 100
"""Largest number of times that a value is found again."""

SETTLED: Final = 1e-13
"""Relative change of a value that has settled."""

BLUNT: Final = 1e-10
"""Where the spring has less than this share of its largest effect, it has none."""


def least_property(
    flank: Flank,
    per_unit: Quantity,
    now: float,
    edges: FloatArray,
    load: Callable[[FloatArray, Side], ComplexArray] | None = None,
) -> Extreme:
    """The least preload or stiffness; the spring has `now`, with the effect `per_unit` of it.

    This is the least x >= 0 with rest + x effect >= 0 over the whole turn, where effect and rest
    are generalised forces in the direction in which the flank pushes, and the other property of the
    spring is unchanged. It comes with the cam angle [rad] that determines it; if no value is enough
    it is infinite, with the cam angle at which none helps. `load` (k, n) is that of pivot or guide
    for one unit more of x; None if there is none.
    """
    if flank.contact.bearings is None:
        return _least(flank, per_unit, now, edges)
    first = _least(flank, per_unit, now, edges, load, now)
    if load is None:
        return first
    return _fixed_point(
        lambda guess: _least(flank, per_unit, now, edges, load, guess),
        first,
        (math.inf,),
        "least value of the spring",
    )


def _least(
    flank: Flank,
    per_unit: Quantity,
    now: float,
    edges: FloatArray,
    load: Callable[[FloatArray, Side], ComplexArray] | None = None,
    guess: float = 0.0,
) -> Extreme:
    """`least_property` with the directions that the loads have at the value `guess`."""

    def parts(phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) effect and rest."""
        outwards = flank.known(phi, side).outwards
        effect = -outwards * per_unit(phi, side)
        if load is None:
            return effect, flank.left(phi, side) - now * effect
        more = (guess - now) * load(phi, side)
        slope = effect + flank.slope(phi, side, more, load(phi, side))
        return slope, flank.left(phi, side, more) + (guess - now) * effect - guess * slope

    # The effect of the spring changes its sign there, and the bound is unbounded beside it.
    cuts = with_roots(lambda phi: per_unit(phi, "right"), edges)
    effects, rests = parts(sample_grid(cuts).ravel(), "right")
    blunt = BLUNT * float(np.max(np.abs(effects)))
    # A rest that is 0 but for rounding lacks nothing.
    none = TOUCH * float(np.max(np.abs(rests)))

    def bound(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) lower bound of the value, 0 where no force is missing."""
        effect, rest = parts(phi, side)
        bounds = np.zeros(len(phi))
        np.divide(-rest, effect, out=bounds, where=(effect > blunt) & (rest < -none))
        bounds[(np.abs(effect) <= blunt) & (rest < -none)] = BOUNDLESS
        return bounds

    def left(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) reserve with the least value; below 0 where a lever has reversed."""
        effect, rest = parts(phi, side)
        return rest + least.value * effect

    least = piecewise_highest(bound, cuts)
    if least.value >= BOUNDLESS:
        return Extreme(np.inf, least.place)
    # Where a lever has reversed, more of the spring lifts the follower: the least value must not be
    # too much there.
    if np.min(effects) < -blunt:
        remaining = piecewise_extremes(left, cuts)
        if remaining.lowest.value < -TOUCH * remaining.magnitude:
            return Extreme(np.inf, remaining.lowest.place)
    return least


def _fixed_point(
    find: Callable[[float], Extreme], value: Extreme, ends: tuple[float, ...], what: str
) -> Extreme:
    """The fixed point of `find`, which takes the directions of the loads at the last value, from
    `value` on; ends early at one of the `ends`.
    """
    for _ in range(MOST_STEPS):
        if value.value in ends:
            return value
        last, value = value, find(value.value)
        if abs(value.value - last.value) <= SETTLED * last.value:
            return value
    raise EffectError(f"the {what} did not converge with the friction in the pivot")


def _speed(flank: Flank, edges: FloatArray, factor: float) -> Extreme:
    """The lift-off speed with the directions that the loads have at `factor`."""

    def discriminant(phi: FloatArray) -> FloatArray:
        r0, r1, r2 = flank.reserve(phi, "right", factor=factor)
        return np.asarray(r1 * r1 - 4.0 * r0 * r2)

    # Where the discriminant is 0, two roots meet and vanish, and the slowness jumps.
    cuts = with_roots(discriminant, edges)
    slowest = piecewise_highest(_slowness(flank, factor), cuts)
    if slowest.value <= 0.0:
        return Extreme(np.inf, slowest.place)
    if slowest.value >= BOUNDLESS:
        return Extreme(0.0, slowest.place)
    return Extreme(1.0 / slowest.value, slowest.place)


def _slowness(flank: Flank, factor: float) -> Quantity:
    """(n,) 1 / f for the smallest positive f with r0 + f r1 + f^2 r2 = 0, or 0 without one."""

    def slowness(phi: FloatArray, side: Side) -> FloatArray:
        r0, r1, r2 = flank.reserve(phi, side, factor=factor)
        r0 = np.maximum(r0, 0.0)
        # Divided by the largest coefficient, so that squares neither overflow nor underflow.
        size = np.maximum(np.maximum(r0, np.abs(r1)), np.abs(r2))
        r0, r1, r2 = np.stack((r0, r1, r2)) / np.where(size > 0.0, size, 1.0)
        square = r1 * r1 - 4.0 * r0 * r2
        root = np.sqrt(np.maximum(square, 0.0))
        # The largest root of r0 k^2 + r1 k + r2, k = 1 / f, in the form without cancellation.
        falling = r1 < 0.0
        above = np.where(falling, root - r1, -2.0 * r2)
        below = np.where(falling, 2.0 * r0, r1 + root)
        bounded = below * BOUNDLESS > above
        values = np.where(above > 0.0, BOUNDLESS, 0.0)
        np.divide(above, below, out=values, where=bounded & (below > 0.0))
        values[square < 0.0] = 0.0
        return np.clip(values, 0.0, BOUNDLESS)

    return slowness


# -- holding --------------------------------------------------------------------------------------
# The spring that holds a follower on its flank.


VectorOf = Callable[[FloatArray, Side], ComplexArray]
"""(k, n) complex at n cam angles [rad]."""


def holding(
    subject: Subject,
    contact: ContactForce,
    spring: Spring,
    least: tuple[Extreme, Extreme] | None = None,
) -> str:
    """Which preload or which stiffness would hold a contact that is lost, each rounded so that it
    does; empty if neither does. They are those of `Flank.least_spring`, without a margin, unless
    `least` are known.
    """
    if least is None:
        flank = Flank(subject, contact, subject.cam.contact.push, 0.0)
        least = flank.least_spring(spring, contact.lost_contact.leaps)
    preload, stiffness = least
    kinds = (
        ("preload", preload, spring.preload, spring.unit_of_preload),
        ("stiffness", stiffness, spring.stiffness, spring.unit_of_stiffness),
    )
    values = [
        f"a {what} of {rounded_beyond(spring_scale(unit) * enough.value, DIGITS, upward=True)}"
        f" {unit} instead of {spring_scale(unit) * now:.6g} {unit}"
        for what, enough, now, unit in kinds
        if math.isfinite(enough.value)
    ]
    return f"{' or '.join(values)} of its spring would hold it" if values else ""


def _pivot_loads(flank: Flank, spring: Spring) -> tuple[VectorOf | None, VectorOf | None]:
    """Loads of a pivot with friction per unit of preload and of stiffness; None without any."""
    line, per_stroke = spring.line, spring.per_stroke
    if flank.contact.bearings is None or flank.subject.cam.follower.pivot is None:
        return None, None
    if line is None and not per_stroke:
        return None, None

    def per_preload(phi: FloatArray, side: Side) -> ComplexArray:
        if line is not None:
            return -line(phi, side)[np.newaxis]
        return flank.passed(phi, side, np.full(len(phi), per_stroke))

    def per_stiffness(phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(-spring.way(phi, side)[0] * per_preload(phi, side))

    return per_preload, per_stiffness
