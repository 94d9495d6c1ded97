"""Balance of the forces on the follower, solved for the normal force at the contact.

Principle of virtual work with d'Alembert's inertia forces (Norton, Machine Design, chapter on cam
design, and Norton, Cam Design and Manufacturing Handbook, chapter on cam dynamics, kinetostatic
analysis; Volmer, Getriebetechnik, Kurvengetriebe, forces at the follower): the generalised forces Q
on the follower's coordinate q and that of the contact add up to zero,

    sum Q + R = 0,     R = |N| (sense dn/dq + p),

with the leverage dn/dq of the normal force, sense +1 where the inner flank carries and -1 where the
outer one does, and the contribution p of Coulomb and rolling friction to q per unit of |N|. Without
friction N = R / (dn/dq). In a conjugate pair sense -1 is the return disc, and sense dn/dq the
leverage of its own inner flank: discs only push, so R is provided by the disc whose leverage has
its sign.

Friction in the pivot or guide grows with whatever loads it, not with |N| alone: the balance and its
only root are in `camgeo.effects.bearing_friction`, and R is replaced by R_0 of that module wherever
its sign is meant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, NoReturn

import numpy as np

from camgeo.effects.bearing_friction import BearingFriction, directions, with_reversals
from camgeo.effects.effect import Subject
from camgeo.effects.force import Force, at_rates, rates_of, smooth_edges, total
from camgeo.effects.results import Friction
from camgeo.effects.touching import INNER, OUTER, carrier, leverage_of, on_carrier
from camgeo.effects.wording import at, between
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import dips, grid_of, piecewise_lowest, stretch_below
from camgeo.numeric.roots import roots_on_grid
from camgeo.numeric.rounding import SHARE
from camgeo.units import TURN

VANISHING: Final = 1e-12
"""A normal force moves nothing if its leverage, with friction, is below this share of the reach of
the follower: a few thousand rounding errors of the roller's position."""


@dataclass(frozen=True, slots=True, eq=False)
class ForceBalance:
    """The forces on the follower, and the force that the contact must add.

    Attributes
    ----------
    subject : the design.
    forces : all except that of the contact.
    friction : at the contact and in the guides, or None.
    bearings : friction under the loads of pivot or guide, or None.
    """

    subject: Subject
    forces: tuple[Force, ...]
    friction: Friction | None
    bearings: BearingFriction | None

    def beside(self, force: Force) -> ForceBalance:
        """The same with a `force` besides."""
        bearings = None if self.bearings is None else self.bearings.beside(force)
        return replace(self, forces=(*self.forces, force), bearings=bearings)

    def rates(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2 or more, n) omega [rad/s] and alpha [rad/s^2] of the scene; 0 if it gives no speed."""
        return rates_of(self.subject, phi, side)

    def demand(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        """(n,) R [N or N mm] at `rates`; exactly 0 where the forces cancel to rounding."""
        needed = np.zeros(len(phi))
        size = np.zeros(len(phi))
        for force in self.forces:
            coefficients = force.coefficients(phi, side)
            needed -= at_rates(coefficients, rates)
            size += at_rates(np.abs(coefficients), np.abs(rates))
        needed[np.abs(needed) <= SHARE * size] = 0.0
        return needed

    def required(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) coefficients of R."""
        return -total(self.forces, phi, side)

    def released(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        """(n,) R_0 [N or N mm] at `rates`; exactly 0 where it is rounding."""
        needed = self.demand(phi, side, rates)
        if self.bearings is None:
            return needed
        alone = self.bearings.alone(phi, side, rates)
        size = np.abs(needed) + self.bearings.largest(phi, side, rates)
        found = needed + alone
        found[np.abs(found) <= SHARE * size] = 0.0
        return found

    def leverage(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(n,) sense dn/dq [1 or mm/rad]: force on q per unit of |N|, without friction.

        Raises
        ------
        EffectError
            Where the pitch curve has a cusp, and thus no normal.
        """
        try:
            return leverage_of(self.subject, phi, side, sense)
        except GeometryError as error:
            raise EffectError(f"there is no contact force: {error.message}") from error

    def bracket(
        self, phi: FloatArray, side: Side, sense: int, leverage: FloatArray | None = None
    ) -> FloatArray:
        """(n,) [1 or mm/rad] force on q per unit of |N| on the side `sense`, of a large |N|.

        `leverage` is that of the side, if already known.
        """
        lever = self.leverage(phi, side, sense) if leverage is None else leverage
        if self.friction is None:
            return lever
        bracket: FloatArray = lever + self.friction.per_normal(phi, side, sense)[0]
        return bracket

    def parts(
        self, phi: FloatArray, side: Side, rates: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """R_0, the side that must carry (+1 or -1), and its reserve against jamming, (n,) each.

        The reserve is the bracket in the direction of R_0, |R_0| = reserve |N| where the contact is
        the only load of pivot or guide. The follower jams where it is not above 0, also between two
        discs that push in the same direction.
        """
        needed = self.released(phi, side, rates)
        lever = self.leverage(phi, side, INNER)
        other = -lever if self.subject.returning is None else self.leverage(phi, side, OUTER)
        sense = np.where(needed * np.sign(lever) >= 0.0, INNER, OUTER)
        inner = self.bracket(phi, side, INNER, lever)
        outer = self.bracket(phi, side, OUTER, other)
        reserve = np.where(sense == INNER, inner, -outer) * np.sign(lever)
        return needed, sense, reserve

    def normal(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        """(n,) N [N], positive where the inner flank carries.

        Raises
        ------
        EffectError
            "jamming", where no normal force on the flank that must carry moves the follower.
        """
        needed, sense, reserve = self.parts(phi, side, rates)
        loaded = needed != 0.0
        jammed = loaded & (reserve <= VANISHING * abs(self.subject.cam.follower.reach))
        if np.any(jammed):
            self.refuse(float(phi[jammed][0]), side)
        found = np.zeros(len(phi))
        if self.bearings is None:
            np.divide(np.abs(needed), reserve, out=found, where=loaded)
        else:
            found[loaded] = self._under_loads(phi, side, rates, sense)[loaded]
        found *= sense
        return found

    def _under_loads(
        self, phi: FloatArray, side: Side, rates: FloatArray, sense: FloatArray
    ) -> FloatArray:
        """(n,) |N| on the side `sense` (n,) with friction in the bearings."""
        found, bearings = np.zeros(len(phi)), self.bearings
        assert bearings is not None
        demand, drag = self.demand(phi, side, rates), bearings.drag(phi, side)
        own = at_rates(bearings.own(phi, side), rates)
        for flank in (INNER, OUTER):
            here = sense == flank
            if not np.any(here):
                continue
            per = bearings.rubbing.per_normal(phi, side, flank)
            free = self.bracket(phi, side, flank) + drag * np.sum(np.abs(per), axis=0)
            u = np.where(demand + drag * np.sum(np.abs(own), axis=0) >= 0.0, 1.0, -1.0)
            n, _ = directions(u * demand, u * free, u * drag, own, per)
            found[here] = n[here]
        return found

    def bearing_loads(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(k, n) the loads that rub in pivot or guide, at the speed of the scene."""
        bearings, rates = self.bearings, self.rates(phi, side)
        assert bearings is not None
        normal = self.normal(phi, side, rates)
        per = on_carrier(normal, lambda sense: bearings.rubbing.per_normal(phi, side, sense))
        return np.asarray(at_rates(bearings.own(phi, side), rates) + per * np.abs(normal))

    def refuse(
        self, angle: float, side: Side, cam_range: tuple[float, float] | None = None
    ) -> NoReturn:
        """Raise EffectError that the follower jams, worst at `angle` [rad]."""
        here = np.array([angle])
        sense = int(self.parts(here, side, self.rates(here, side))[1][0])
        curve = carrier(self.subject, sense)[0].state.curve

        def transmission(*angles: float) -> float:
            return math.degrees(float(np.max(curve.transmission_angle(np.array(angles), side))))

        value: float | None = transmission(angle)
        limit: float | None = 0.0
        where = at(angle) if cam_range is None else between(cam_range)
        if self.friction is not None and not self.subject.cam.follower.rolls:
            value = limit = None
            why = "friction absorbs the entire contact force"
        elif cam_range is None or self.friction is None:
            what = self.subject.cam.follower.touching
            why = f"the transmission angle is {value:.4g} deg, and no force on the {what} moves it"
        else:
            limit = transmission(*cam_range)
            why = (
                f"the transmission angle falls to {value:.4f} deg; with this friction it must be"
                f" above {limit:.4f} deg"
            )
        raise EffectError(
            f"the follower jams {where}: {why}",
            finding="jamming",
            value=value,
            limit=limit,
            unit="deg",
            cam_angle=angle % TURN,
            cam_range=cam_range,
        )


def edges_of(balance: ForceBalance) -> FloatArray:
    """(k,) cam angles [rad] from 0 to 2 pi between which the normal force is smooth.

    They are the smooth angles of the motion, the borders of the forces, and the roots of R_0 and of
    the leverage, at which the flank that carries changes.
    """
    edges = smooth_edges(balance.subject.state.smooth_angles, balance.forces)
    grid = grid_of(edges)

    def demand(phi: FloatArray) -> FloatArray:
        return balance.released(phi, "right", balance.rates(phi, "right"))

    def leverage(phi: FloatArray, sense: int) -> FloatArray:
        return balance.leverage(phi, "right", sense)

    senses = (INNER,) if balance.subject.returning is None else (INNER, OUTER)
    inner = grid_of(merged(np.concatenate((edges, dips(demand, grid)))))
    found = [edges, roots_on_grid(demand, inner)]
    found += [roots_on_grid(partial(leverage, sense=sense), grid) for sense in senses]
    return merged(np.concatenate(found))


def load_edges(balance: ForceBalance, edges: FloatArray) -> FloatArray:
    """(k,) `edges`, and the cam angles [rad] at which a force at an end of a guide reverses.

    Its friction has a kink there; that of a pivot has none, unless its load is 0.
    """
    if balance.bearings is None or balance.subject.cam.follower.pivot is not None:
        return edges
    return with_reversals(lambda phi: balance.bearing_loads(phi, "right").real, edges)


def refuse_jamming(balance: ForceBalance, edges: FloatArray) -> None:
    """Raise EffectError if the follower jams between any two of `edges`.

    Self-locking (Rothbart, Cam Design Handbook, chapter on forces, and Volmer, Kurvengetriebe, on
    the transmission angle): friction exceeds the component of the normal force along the path of
    the follower. Without friction this happens at transmission angle 0.
    """
    least = VANISHING * abs(balance.subject.cam.follower.reach)

    def reserve(phi: FloatArray, side: Side) -> FloatArray:
        needed, _, left = balance.parts(phi, side, balance.rates(phi, side))
        return np.where(needed != 0.0, left, abs(balance.subject.cam.follower.reach)) - least

    lowest = piecewise_lowest(reserve, edges)
    if lowest.value > 0.0:
        return
    stretch = stretch_below(lambda phi: reserve(phi, "right"), edges, lowest.place)
    if stretch is None:
        balance.refuse(lowest.place, "right")
    else:
        side: Side = "left" if lowest.place == stretch[1] else "right"
        balance.refuse(lowest.place, side, stretch)
