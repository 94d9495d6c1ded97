"""The flank on which the follower must stay, and the force that holds it there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.bearing_friction import unit_vectors
from camgeo.effects.effect import Subject
from camgeo.effects.force import at_rates, rates_of, smooth_edges
from camgeo.effects.results import ContactForce
from camgeo.effects.touching import lowest_on_flank, outwards_of
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import Extreme
from camgeo.numeric.rounding import SHARE


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

    def outwards(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) direction of q in which the flank pushes, +1 or -1."""
        return outwards_of(self.subject, phi, side, self.sense)

    @property
    def turning(self) -> bool:
        """Whether loads that rub change direction with the speed: then `reserve` has no fixed
        coefficients.
        """
        bearings = self.contact.bearings
        return bearings is not None and bool(np.any(bearings.own(self.base_edges, "right")[1:]))

    def left(self, phi: FloatArray, side: Side, more: ComplexArray | None = None) -> FloatArray:
        """(n,) the reserve at the speed of the scene, with the train of its state; for `more` see
        `reserve`.
        """
        behind = self.contact.behind
        found: FloatArray = np.sum(self.reserve(phi, side, more=more), axis=0)
        if behind is not None:
            found -= self.outwards(phi, side) * behind.beyond_rigid(phi, side)
        return found

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
        exact. `more` (n,) complex is added to the load of the pivot.
        """
        course = self.subject.state.course
        omega, alpha = np.zeros((2, len(phi))) if course is None else course.rates(phi, side)[:2]
        needed = np.zeros((3, len(phi)))
        size = np.zeros((3, len(phi)))
        for force in self.contact.lasting:
            c0, c1, c2, c3 = force.coefficients(phi, side)
            parts = np.stack((c0, c1 * omega, c2 * omega * omega + c3 * alpha))
            needed -= parts
            size += np.abs(parts)
        if self.margin:
            bracket = self.margin * self.contact.bracket(phi, side, self.sense)
            needed[0] -= bracket
            size[0] += np.abs(bracket)
        if self.contact.bearings is not None:
            rubbed, most = self._rubbing(phi, side, np.stack((omega, alpha)), factor, more)
            needed += rubbed
            size += most
        needed[np.abs(needed) <= SHARE * size] = 0.0
        needed *= self.outwards(phi, side)
        return needed

    def slope(
        self, phi: FloatArray, side: Side, more: ComplexArray, per_unit: ComplexArray
    ) -> FloatArray:
        """(n,) derivative of w |L| at the speed of the scene, as the load L of the pivot, which has
        `more` (n,), goes on by `per_unit` (n,).
        """
        bearings = self.contact.bearings
        assert bearings is not None
        per = bearings.rubbing.per_normal(phi, side, self.sense)
        own = at_rates(bearings.own(phi, side), rates_of(self.subject, phi, side))
        load = own + self.margin * per + more
        d = unit_vectors(load, np.ones_like(load))[0]
        return np.asarray(bearings.drag(phi, side) * (np.conj(d) * per_unit).real)

    def _rubbing(
        self,
        phi: FloatArray,
        side: Side,
        rates: FloatArray,
        factor: float,
        more: ComplexArray | None,
    ) -> tuple[FloatArray, FloatArray]:
        """(3, n) coefficients of w sum |L_i| less what the bracket of the margin has of it, and the
        sizes of their terms, see `camgeo.effects.bearing_friction`.
        """
        bearings = self.contact.bearings
        assert bearings is not None
        omega, alpha = rates
        drag, own = bearings.drag(phi, side), bearings.own(phi, side)
        by_contact = self.margin * bearings.rubbing.per_normal(phi, side, self.sense)
        loads = np.stack((own[0] + by_contact, own[1] * omega, own[2] * omega**2 + own[3] * alpha))
        if more is not None:
            loads[0] += more
        total = loads[0] + factor * (loads[1] + factor * loads[2])
        d = unit_vectors(total, np.ones_like(total))
        found = drag * np.sum((np.conj(d) * loads).real, axis=1)
        found[0] -= drag * np.sum(np.abs(by_contact), axis=0)
        return found, np.abs(drag) * np.sum(np.abs(loads), axis=1)
