"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, NoReturn

import numpy as np

from camgeo.check.finding import Finding, Severity, limit_finding
from camgeo.dynamics.effects.bearing_friction import BearingFriction, solve_balance
from camgeo.dynamics.effects.contact import (
    INNER,
    OUTER,
    carrier,
    contact_leverage,
    holds_both_ways,
    lost_contact,
    require_convex,
    select_carrier,
    side_names,
)
from camgeo.dynamics.effects.effect import Column, Quantity, Request, Subject
from camgeo.dynamics.effects.forces import (
    ElasticTrain,
    Force,
    all_borders,
    at_rates,
    cam_rates,
    shocks,
    smooth_edges,
)
from camgeo.dynamics.effects.loads import follower_loads
from camgeo.dynamics.effects.results import (
    ACTING,
    FRICTION,
    INERTIA,
    VIBRATION,
    ContactForce,
    Friction,
    Inertia,
)
from camgeo.dynamics.effects.wording import (
    at_angle,
    at_angles,
    by_place,
    over_range,
    placed,
    resolved_ends,
)
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import SHARE, ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import (
    Extreme,
    Extremes,
    dips,
    piecewise_extremes,
    piecewise_lowest,
    roots_on_grid,
    sample_grid,
    stretch_below,
    with_roots,
)
from camgeo.numeric.kept import MOST_ANGLES, recalling
from camgeo.units import TURN


def compute(request: Request[Mapping[str, Any]]) -> ContactForce:
    """The contact force.

    Raises
    ------
    EffectError
        "jamming", if the follower jams anywhere in the turn; if the pitch curve has a cusp.
    """
    subject, friction = request.subject, request.results.get(FRICTION)
    acting = [request.results.get(key) for key in ACTING]
    forces = [effect.force for effect in acting if effect is not None]
    if friction is not None:
        forces.append(friction.force)
    require_convex(subject, "contact force")
    bearings = bearing_friction(request, tuple(forces))
    rigid = ForceBalance(subject, tuple(forces), friction, bearings)
    inertia, vibration = request.results.get(INERTIA), request.results.get(VIBRATION)
    behind = None if vibration is None else vibration.behind
    balance = rigid
    if behind is not None:
        # What an elastic train passes on beyond a rigid one is one more force.
        train = behind.force(subject.state.smooth_angles)
        balance = rigid.with_force(train)
    edges = force_edges(balance)
    refuse_jamming(balance, edges)
    # The loads follow from the normal force, which is known only where nothing jams.
    edges = load_edges(balance, edges)

    @recalling  # all effects of the scene ask for it, most of them at the same angles
    def normal(phi: FloatArray, side: Side) -> FloatArray:
        return balance.normal(phi, side, balance.rates(phi, side))

    @recalling
    def demand(phi: FloatArray, side: Side) -> FloatArray:
        return balance.demand(phi, side, balance.rates(phi, side))

    limit = request.data.get("limit")
    extremes = piecewise_extremes(normal, edges)
    findings = force_findings(extremes, subject, limit)
    columns = _columns(subject, normal, limit, all_borders(forces))
    struck = struck_mass(inertia, behind)
    contact_force = ContactForce(
        findings=(
            *findings,
            *shock_findings(subject, struck),
        ),
        columns=columns,
        lost_contact=lost_contact(subject, normal, extremes, edges, struck),
        forces=balance.forces,
        friction=friction,
        edges=edges,
        extremes=extremes,
        required=rigid.required,
        normal=normal,
        normal_at_rates=rigid.normal,
        bracket=balance.bracket,
        demand=demand,
        bearings=rigid.bearings,
        released=rigid.released,
        with_force=lambda force: add_force(contact_force, rigid, force),
        struck=struck,
        behind=behind,
    )
    return contact_force


def add_force(contact: ContactForce, rigid: ForceBalance, force: Force) -> ContactForce:
    """The `contact` force with one more `force`, see `ContactForce.with_force`; `rigid` is the
    balance with a rigid train.
    """
    balance = rigid.with_force(force)
    return replace(
        contact,
        forces=balance.forces,
        bearings=balance.bearings,
        required=balance.required,
        normal_at_rates=balance.normal,
        released=balance.released,
    )


def bearing_friction(
    request: Request[Mapping[str, Any]], forces: tuple[Force, ...]
) -> BearingFriction | None:
    """Friction under the loads of pivot or guide with these `forces`; None if the scene has none.

    Raises
    ------
    EffectError
        If the follower cannot move the far end of its linkage, on which something acts.
    """
    friction = request.results.get(FRICTION)
    if friction is None or friction.rubbing is None:
        return None
    loads = follower_loads(request.subject, request.results, forces, idle=False)
    return BearingFriction(
        friction.rubbing,
        recalling(partial(loads.on_bearings, friction), MOST_ANGLES),
        partial(loads.per_far, friction),
    )


def struck_mass(inertia: Inertia | None, behind: ElasticTrain | None) -> Quantity | None:
    """See `ContactForce.struck`."""
    if inertia is None:
        return None
    if behind is None:
        return inertia.to_follower

    def in_front(phi: FloatArray, side: Side) -> FloatArray:
        return inertia.to_follower(phi, side) - behind.reduced(phi, side)

    return in_front


def _columns(
    subject: Subject, normal: Quantity, limit: float | None, borders: FloatArray
) -> tuple[Column, ...]:
    """The signed force; between two discs, or in a yoke, that of each side, which only pushes."""
    if subject.returning is None:
        signed = None if limit is None else subject.cam.contact.push * limit
        return (Column("contact force", "N", normal, signed, borders),)

    def pushing(sense: int) -> Quantity:
        return lambda phi, side: np.maximum(sense * normal(phi, side), 0.0)

    names, _ = side_names(subject)
    return tuple(
        Column(f"{names[sense]} contact force", "N", pushing(sense), limit, borders)
        for sense in (INNER, OUTER)
    )


def force_findings(extremes: Extremes, subject: Subject, limit: float | None) -> list[Finding]:
    """Largest and smallest force on the flank in use, or the largest force of each side.

    The sides are the flanks of a groove, the discs of a conjugate pair or those of a yoke.
    """
    names, noun = side_names(subject)
    extremes = resolved_ends(extremes)
    low, high = extremes.lowest, extremes.highest
    mirrored = Extreme(-low.value, low.place)
    if not holds_both_ways(subject):
        inner = subject.cam.contact.runs_inside
        where = f"the {subject.cam.contact} flank"
        smallest = low if inner else Extreme(-high.value, high.place)
        largest = _largest(high if inner else mirrored, where, limit)
        return [largest, _smallest(smallest, where, subject.cam.follower.touching)]
    both = sorted(((high, INNER), (mirrored, OUTER)), key=lambda pair: -pair[0].value)
    findings = [_largest(both[0][0], f"the {names[both[0][1]]} {noun}", limit)]
    for extreme, sense in both:
        if extreme.value > 0.0:
            text = f"largest contact force {_value(extreme, f'the {names[sense]} {noun}')}"
            findings.append(placed(f"largest-contact-force-{names[sense]}", text, extreme, "N"))
    return findings


def _largest(extreme: Extreme, where: str, limit: float | None) -> Finding:
    text = f"largest contact force {_value(extreme, where)}"
    return limit_finding("largest-contact-force", text, extreme.value, limit, "N", extreme.place)


def _smallest(extreme: Extreme, where: str, what: str) -> Finding:
    lost = extreme.value < 0.0
    tail = f": the {what} is not held on its flank there" if lost else ""
    sentence = f"smallest contact force {_value(extreme, where)}{tail}"
    severity: Severity = "warning" if lost else "ok"
    return placed("smallest-contact-force", sentence, extreme, "N", severity=severity)


def _value(extreme: Extreme, where: str) -> str:
    return f"on {where} {extreme.value:.6g} N {at_angle(extreme.place)}"


def shock_findings(subject: Subject, struck: Quantity | None) -> list[Finding]:
    """Findings on jumps of the velocity of a mass, at which the force is infinite; no value
    includes it.
    """
    return [
        Finding(
            name="shock",
            severity="broken",
            sentence=(
                f"the velocity jumps {at_angles(places)}: the inertia force at the contact is"
                " infinite for an instant, and not included in any value"
            ),
            cam_angle=places[0],
        )
        for places in by_place(shocks(subject, struck))
    ]


# -- balance --------------------------------------------------------------------------------------
# Balance of the forces on the follower, solved for the normal force at the contact.
#
# Principle of virtual work with d'Alembert's inertia forces (Norton, Machine Design, chapter on cam
# design, and Norton, Cam Design and Manufacturing Handbook, chapter on cam dynamics, kinetostatic
# analysis; Volmer, Getriebetechnik, Kurvengetriebe, forces at the follower): the generalised forces
# Q on the follower's coordinate q and that of the contact add up to zero,
#
#     sum Q + R = 0,     R = |N| (sense dn/dq + p),
#
# with the leverage dn/dq of the normal force, sense +1 where the inner flank carries and -1 where
# the outer one does, and the contribution p of Coulomb and rolling friction to q per unit of |N|.
# Without friction N = R / (dn/dq). In a conjugate pair sense -1 is the return disc, and sense dn/dq
# the leverage of its own inner flank: discs only push, so R is provided by the disc whose leverage
# has its sign.
#
# Friction in the pivot or guide grows with whatever loads it, not with |N| alone: the balance and
# its only root are in `camgeo.dynamics.effects.bearing_friction`, and R is replaced by R_0 of that
# module wherever its sign is meant.


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

    def with_force(self, force: Force) -> ForceBalance:
        """The balance with one more `force`."""
        bearings = None if self.bearings is None else self.bearings.with_force(force)
        return replace(self, forces=(*self.forces, force), bearings=bearings)

    def rates(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2 or more, n) omega [rad/s] and alpha [rad/s^2] of the scene; 0 if it gives no speed."""
        return cam_rates(self.subject, phi, side)

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
        coefficients = np.zeros((4, len(phi)))
        for force in self.forces:
            coefficients += force.coefficients(phi, side)
        return -coefficients

    def released(self, phi: FloatArray, side: Side, rates: FloatArray) -> FloatArray:
        """(n,) R_0 [N or N mm] at `rates`; exactly 0 where it is rounding."""
        needed = self.demand(phi, side, rates)
        if self.bearings is None:
            return needed
        alone = self.bearings.noncontact_friction(phi, side, rates)
        size = np.abs(needed) + self.bearings.largest(phi, side, rates)
        remainder = needed + alone
        remainder[np.abs(remainder) <= SHARE * size] = 0.0
        return remainder

    def leverage(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(n,) sense dn/dq [1 or mm/rad]: force on q per unit of |N|, without friction.

        Raises
        ------
        EffectError
            Where the pitch curve has a cusp, and thus no normal.
        """
        try:
            return contact_leverage(self.subject, phi, side, sense)
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
        return np.asarray(lever + self.friction.per_normal(phi, side, sense)[0])

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
        # The inner flank pushes along its leverage; the other side has to carry what is demanded
        # the other way.
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
        forces = np.zeros(len(phi))
        if self.bearings is None:
            np.divide(np.abs(needed), reserve, out=forces, where=loaded)
        else:
            forces[loaded] = self._loaded_normal(self.bearings, phi, side, rates, sense)[loaded]
        forces *= sense
        return forces

    def _loaded_normal(
        self,
        bearings: BearingFriction,
        phi: FloatArray,
        side: Side,
        rates: FloatArray,
        sense: FloatArray,
    ) -> FloatArray:
        """(n,) |N| on the side `sense` (n,) with friction in the bearings."""
        normal = np.zeros(len(phi))
        demand, drag = self.demand(phi, side, rates), bearings.drag(phi, side)
        noncontact = at_rates(bearings.noncontact_loads(phi, side), rates)
        for flank in (INNER, OUTER):
            here = sense == flank
            if not np.any(here):
                continue
            per = bearings.rubbing.per_normal(phi, side, flank)
            # The bracket is reduced by the friction of the contact's load alone; here b is without
            # it, because the loads include it.
            free = self.bracket(phi, side, flank) + drag * np.sum(np.abs(per), axis=0)
            # The direction in which the flank must push: both sides of the balance are multiplied
            # by it.
            u = np.where(demand + drag * np.sum(np.abs(noncontact), axis=0) >= 0.0, 1.0, -1.0)
            n, _ = solve_balance(u * demand, u * free, u * drag, noncontact, per)
            normal[here] = n[here]
        return normal

    def bearing_loads(self, bearings: BearingFriction, phi: FloatArray, side: Side) -> ComplexArray:
        """(k, n) the loads that rub in pivot or guide, at the speed of the scene."""
        rates = self.rates(phi, side)
        normal = self.normal(phi, side, rates)
        per = select_carrier(normal, lambda sense: bearings.rubbing.per_normal(phi, side, sense))
        return np.asarray(
            at_rates(bearings.noncontact_loads(phi, side), rates) + per * np.abs(normal)
        )

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
        where = at_angle(angle) if cam_range is None else over_range(cam_range)
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


def force_edges(balance: ForceBalance) -> FloatArray:
    """(k,) cam angles [rad] from 0 to 2 pi between which the normal force is smooth.

    They are the smooth angles of the motion, the borders of the forces, and the roots of R_0 and of
    the leverage, at which the flank that carries changes.
    """
    edges = smooth_edges(balance.subject.state.smooth_angles, balance.forces)
    grid = sample_grid(edges)

    def demand(phi: FloatArray) -> FloatArray:
        return balance.released(phi, "right", balance.rates(phi, "right"))

    def leverage(phi: FloatArray, sense: int) -> FloatArray:
        return balance.leverage(phi, "right", sense)

    senses = (INNER,) if balance.subject.returning is None else (INNER, OUTER)
    # Where R_0 dips below 0 between two points of the grid, both roots would be missed.
    inner = sample_grid(merged(np.concatenate((edges, dips(demand, grid)))))
    angles = [edges, roots_on_grid(demand, inner)]
    angles += [roots_on_grid(partial(leverage, sense=sense), grid) for sense in senses]
    return merged(np.concatenate(angles))


def load_edges(balance: ForceBalance, edges: FloatArray) -> FloatArray:
    """(k,) `edges`, and the cam angles [rad] at which a force at an end of a guide reverses.

    Its friction has a kink there; that of a pivot has none, unless its load is 0.
    """
    bearings = balance.bearings
    if bearings is None or balance.subject.cam.follower.pivot is not None:
        return edges
    return with_roots(lambda phi: balance.bearing_loads(bearings, phi, "right").real, edges)


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
        # At the end of the range the values inside it are meant.
        side: Side = "left" if lowest.place == stretch[1] else "right"
        balance.refuse(lowest.place, side, stretch)
