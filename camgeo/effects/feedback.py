"""The speed of a motor-driven cam before an elastic train: a fixed point.

The torque on the camshaft makes its speed, the speed the vibration of the train, the vibration the
force at the contact, and this the torque. Each round takes the speed omega_k of the one before it,
computes the force of the train for it, and with this force over the cam angle the speed omega_k+1 =
G(omega_k); the first one takes the train as rigid. Of the masses behind the train, the torque has
the inertia at the new speed and the difference from it at the former one, so that a stiff train
changes little.

Where G contracts, |G(a) - G(b)| <= q |a - b| with q < 1, there is one fixed point (Banach), and a
round with the error e of its own is off from it by no more than (e + q r) / (1 - q), where r is
its change |omega_k+1 - omega_k|. All are the largest over the turn. q is estimated, by the ratio of
the last changes, so the error is stated as (e + r) / (1 - q).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from camgeo.effects.bearing_friction import with_force
from camgeo.effects.catalogue import Catalogue
from camgeo.effects.effect import Subject
from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.force import Force
from camgeo.effects.nodes import TOLERANCE, Nodes
from camgeo.effects.results import (
    DRIVE_TORQUE,
    SPEED_FLUCTUATION,
    VIBRATION,
    DriveTorque,
    Feedback,
    MotorTurning,
)
from camgeo.errors import EffectError
from camgeo.lazy import Ledger
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import RPM

ROUNDS: Final = 20
"""Number of rounds after which the iteration counts as one that does not contract."""

OWN: Final = 0.5
"""Share of the tolerance for the speed of each round; the rest is for the rounds that are left."""


class FedBack(Nodes):
    """What a motor turns, with a rigid train, and the speed at which it turns with the elastic one.

    Parameters
    ----------
    catalogue : in which effects take the elastic train into account.
    others : see `Nodes`.
    """

    def __init__(
        self,
        subject: Subject,
        catalogue: Catalogue,
        ledger: Ledger,
        known: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(subject, catalogue.rigid(), ledger, known)
        self._elastic = catalogue

    def _compute(self, name: str) -> Any:
        if name != SPEED_FLUCTUATION:
            return super()._compute(name)
        return self._steady()

    def _steady(self) -> MotorTurning:
        """The fixed point; the answer of the rigid train if nothing behind it has mass.

        Raises
        ------
        EffectError
            "feedback", if the iteration does not contract; and as the effects of a round.
        """
        drive = self.result(DRIVE_TORQUE)
        table = self.catalogue.tables.get(SPEED_FLUCTUATION, {})
        own = {**table, "tolerance": OWN * float(table.get("tolerance", TOLERANCE))}
        catalogue = self.catalogue.with_table(SPEED_FLUCTUATION, own)
        turns: list[MotorTurning] = [super()._compute(SPEED_FLUCTUATION)]
        changes: list[float] = []
        for count in range(1, ROUNDS + 1):
            ledger = self.ledger.named(f" in round {count}")
            try:
                train = self._train(turns[-1].course, ledger)
                if train is None:
                    return turns[0]
                fed: dict[str, Any] = {DRIVE_TORQUE: _loaded(drive, train)}
                nodes = Nodes(self.subject, catalogue, ledger, fed)
                with np.errstate(divide="ignore", invalid="ignore"):  # in rounds that diverge
                    turns.append(nodes.result(SPEED_FLUCTUATION))
            except EffectError as error:
                raise _refused(f"round {count} has no answer, {error.message}", error) from error
            changes.append(_largest_change(turns[-2], turns[-1]))
            found = _left(changes, turns[-1])
            if found is not None:
                return turns[-1].fed_back(found, _rough_of(turns, found))
        change = changes[-1] / RPM
        raise _refused(f"after {ROUNDS} rounds the speed still changes by {change:.3g} rev/min")

    def _train(self, course: TimeCourse, ledger: Ledger) -> Force | None:
        """The force of the train with the cam turning as `course` says, as one that lasts; None if
        nothing behind the train has mass.
        """
        known = {each: self.result(each) for each in self._elastic.received(VIBRATION)}
        subject = self.subject.turning(course)
        behind: ElasticTrain | None = (
            Nodes(subject, self._elastic, ledger, known).result(VIBRATION).behind
        )
        if behind is None:
            return None
        return replace(behind.force(subject.state.smooth_angles), present=False)


def _refused(why: str, error: EffectError | None = None) -> EffectError:
    """That there is no fixed point, `why`, and which keys of the scene do without it."""
    return EffectError(
        f"no common steady state of the cam's speed and its elastic train was found: {why}; in"
        ' [state], output = "rigid" takes the train as rigid, and speed = "stated" keeps the speed'
        " of [cam]",
        finding="feedback",
        cam_angle=None if error is None else error.cam_angle,
    )


def _loaded(drive: DriveTorque, train: Force) -> DriveTorque:
    """`drive`, of a rigid train, with the force `train` besides."""

    def law(phi: FloatArray, side: Side) -> FloatArray:
        return with_force(drive.law(phi, side), drive.contact.bearings, train, phi, side)

    return replace(drive, contact=drive.contact.beside(train), law=law)


def _largest_change(last: MotorTurning, now: MotorTurning) -> float:
    """The largest difference of the speeds [rad/s], at the places of both."""
    phi = np.concatenate((last.places, now.places))
    return float(np.max(np.abs(now.course.rates(phi)[0] - last.course.rates(phi)[0])))


def _left(changes: Sequence[float], now: MotorTurning) -> Feedback | None:
    """What is left to do after rounds with these `changes` [rad/s]; None while that is more than
    the error of the speed `now` itself.
    """
    if len(changes) < 2:
        return None
    change, own = changes[-1], now.speed.error
    ratio = change / changes[-2] if changes[-2] > 0.0 else 0.0
    if not change <= (1.0 - ratio) * own:
        return None
    return Feedback(len(changes), change, ratio, (own + change) / (1.0 - ratio) - own)


def _rough_of(turns: Sequence[MotorTurning], found: Feedback) -> TimeCourse:
    """The course of the last round that is farther from the fixed point than the present one, on
    cells twice as long.
    """
    for last in turns[-2::-1]:
        if _largest_change(last, turns[-1]) >= found.error:
            return last.rough_course
    return turns[0].rough_course
