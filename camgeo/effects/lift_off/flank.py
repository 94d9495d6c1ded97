"""The flank on which the follower must stay, and the force that holds it there."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from camgeo.effects.bearing_friction import unit_vectors
from camgeo.effects.effect import Subject
from camgeo.effects.force import rates_of, smooth_edges
from camgeo.effects.results import ContactForce
from camgeo.effects.touching import lowest_on_flank, outwards_of
from camgeo.motion.kept import Answers
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, read_only
from camgeo.numeric.extremes import Extreme
from camgeo.numeric.rounding import SHARE


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """What is the same at all speeds of n cam angles; read-only.

    Attributes
    ----------
    outwards, drag, loads, needed, size : see `Flank`; the last two are those of `Flank.plain`.
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
    _recent: Answers[_Known] = field(default_factory=Answers, init=False, repr=False)

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

    def _known(self, phi: FloatArray, side: Side) -> _Known:
        """Computed once for recent requests: a search over the speed asks again and again."""

        def made() -> _Known:
            outwards = outwards_of(self.subject, phi, side, self.sense)
            bearings, still = self.contact.bearings, np.zeros(len(phi))
            drag, per_far = still, np.zeros((0, len(phi)), dtype=np.complex128)
            if bearings is not None:
                drag = outwards * bearings.drag(phi, side)
                per_far = bearings.per_far(phi, side)
            needed, size = self._plain(phi, side, outwards, drag)
            return _Known(
                outwards=read_only(outwards),
                drag=read_only(drag),
                loads=read_only(self._loads(phi, side)),
                needed=read_only(needed),
                size=read_only(size),
                per_far=read_only(per_far),
            )

        return self._recent.recall(made, side, phi)

    def outwards(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) direction of q in which the flank pushes, +1 or -1."""
        return self._known(phi, side).outwards

    def drag(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) w [1 or mm], see `camgeo.effects.bearing_friction`, in the direction of the flank; 0
        without friction in pivot or guide.
        """
        return self._known(phi, side).drag

    def loads(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(3, k, n) coefficients l0, l1, l2 of the loads l0 + f l1 + f^2 l2 that rub in pivot or
        guide under the margin, with a rigid train; f as for `reserve`.
        """
        return self._known(phi, side).loads

    def _loads(self, phi: FloatArray, side: Side) -> ComplexArray:
        bearings = self.contact.bearings
        if bearings is None:
            return np.zeros((3, 0, len(phi)), dtype=np.complex128)
        (omega, alpha), own = rates_of(self.subject, phi, side)[:2], bearings.own(phi, side)
        by_contact = self.margin * bearings.rubbing.per_normal(phi, side, self.sense)
        return np.stack(
            (own[0] + by_contact, own[1] * omega, own[2] * omega * omega + own[3] * alpha)
        )

    def passed(self, phi: FloatArray, side: Side, push: FloatArray) -> ComplexArray:
        """(k, n) of these loads by a force `push` (n,) on the far member of a linkage."""
        return np.asarray(self._known(phi, side).per_far * push)

    def left(self, phi: FloatArray, side: Side, more: ComplexArray | None = None) -> FloatArray:
        """(n,) the reserve at the speed of the scene, with the train of its state; for `more` see
        `reserve`.
        """
        passed, behind = self._of_train(phi, side), self.contact.behind
        total = passed if more is None else passed + more
        found: FloatArray = np.sum(self.reserve(phi, side, more=total), axis=0)
        if behind is not None:
            found -= self.outwards(phi, side) * behind.beyond_rigid(phi, side)
        return found

    def _of_train(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(k, n) what the train of the state adds to the loads."""
        behind = self.contact.behind
        push = np.zeros(len(phi)) if behind is None else behind.beyond_base(phi, side)
        return self.passed(phi, side, push)

    def plain(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(3, n) the coefficients of `reserve` but for friction under the `loads`, and the sizes of
        their terms.
        """
        known = self._known(phi, side)
        return known.needed, known.size

    def _plain(
        self, phi: FloatArray, side: Side, outwards: FloatArray, drag: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        omega, alpha = rates_of(self.subject, phi, side)[:2]
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
        needed *= outwards
        bearings = self.contact.bearings
        if bearings is not None:  # the bracket has the friction of the margin alone
            per = bearings.rubbing.per_normal(phi, side, self.sense)
            needed[0] -= self.margin * drag * np.sum(np.abs(per), axis=0)
        return needed, size

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
        known = self._known(phi, side)
        loads, drag = known.loads, known.drag
        if more is not None:
            loads = np.concatenate((loads[:1] + more, loads[1:]))
        total = loads[0] + factor * (loads[1] + factor * loads[2])
        d = unit_vectors(total, np.ones_like(total))
        found: FloatArray = known.needed + drag * np.sum((np.conj(d) * loads).real, axis=1)
        size = known.size + np.abs(drag) * np.sum(np.abs(loads), axis=1)
        found[np.abs(found) <= SHARE * size] = 0.0
        return found

    def slope(
        self, phi: FloatArray, side: Side, more: ComplexArray, per_unit: ComplexArray
    ) -> FloatArray:
        """(n,) derivative of w sum |L| at the speed of the scene, with the train of its state, as
        the loads, which have `more` (k, n), go on by `per_unit` (k, n).
        """
        load = np.sum(self.loads(phi, side), axis=0) + self._of_train(phi, side) + more
        d = unit_vectors(load, np.ones_like(load))
        return np.asarray(self.drag(phi, side) * np.sum((np.conj(d) * per_unit).real, axis=0))
