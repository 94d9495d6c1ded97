"""How the cam turns before an elastic train: a fixed point.

The torque on the camshaft makes the speed of the cam, by its motor (`speed-fluctuation`) or by the
windup of its shaft (`camshaft-windup`), the speed the vibration of the train, the vibration the
force at the contact, and this the torque. With the force F over the cam angle the speed is S(F),
and at this the train has the force T(S(F)), which must be F. The first speed is that of a rigid
train. Each round computes T of the last speed, and the speed with this force and with what a
Newton step adds, c = T'S' (1 - T'S')^-1 (T - F), for the derivatives that are in
`camgeo.effects.tangent`. Of the masses behind the train, the torque has the inertia at the new
speed and the difference from it at the former one, so that a stiff train changes little.

Rounds are a map of speeds, omega -> H(omega). Where it contracts, |H(a) - H(b)| <= q |a - b| with
q < 1, there is one fixed point (Banach). From an exact round whose change is r = |H(omega) - omega|
it is no farther than q r / (1 - q). In a round the speed has an error e, and the force one from
which an error f of the speed follows (`camgeo.effects.shaft.spread`). Both are passed on, by the
Newton step as (1 - S'T')^-1 = P has it; so a speed is off by no more than

    e + (q (r + 2 e) + |P - 1| e + |P| f) / (1 - q) = e + d.

What else is solved for, the windup, changes by no more than p times as much as the speed, and is
off by no more than its own error and p d. All are the largest over the turn. q and p are estimated,
by the ratios between the last rounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.bearing_friction import with_force
from camgeo.effects.catalogue import Catalogue
from camgeo.effects.effect import Subject
from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.force import Force
from camgeo.effects.nodes import TOLERANCE, Nodes
from camgeo.effects.results import DRIVE_TORQUE, VIBRATION, DriveTorque, Turning
from camgeo.effects.shaft.mesh import laws_of
from camgeo.effects.shaft.rate import StuckError
from camgeo.effects.shaft.spread import spread
from camgeo.effects.sought import Feedback
from camgeo.effects.tangent import GRID, Passed, on_base, tangent
from camgeo.errors import EffectError
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import RPM
from camgeo.wording import listed

ROUNDS: Final = 20
"""Number of rounds after which the iteration counts as one that does not contract."""

OWN: Final = 0.25
"""Share of the tolerance for what each round finds; the rest is for the rounds that are left."""


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """A round.

    Attributes
    ----------
    turn : how the cam turns.
    drive : what is turned, with the force that the round takes for that of the train.
    force : this force [N or N mm] on the base of the train, at cam angles of an even grid.
    off : the errors of `Turning.sought` that follow from that of the train.
    sizes : |P - 1| and |P| of the step.
    """

    turn: Turning
    drive: DriveTorque
    force: FloatArray
    off: tuple[float, ...]
    sizes: tuple[float, float]

    def change(self, other: Round) -> FloatArray:
        """(d,) the largest differences of what is sought from that of the `other` round."""
        phi = np.concatenate([each.turn.mesh.nodes.ravel() for each in (self, other)])
        both = zip(self.turn.sought, other.turn.sought, strict=True)
        return np.array([np.max(np.abs(a.values(phi) - b.values(phi))) for a, b in both])


class FedBack(Nodes):
    """What turns the cam, with a rigid train, and how it turns with the elastic one.

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
        found = super()._compute(name)
        return self._steady(name, found) if name == self.catalogue.finder else found

    def _steady(self, name: str, rigid: Turning) -> Turning:
        """The fixed point of the effect `name`; `rigid`, the answer of a rigid train, if nothing
        behind it has mass.

        Raises
        ------
        EffectError
            "feedback", if the iteration does not contract; and as the effects of a round.
        """
        tolerance = float(self.catalogue.tables[name].get("tolerance", TOLERANCE))
        rounds = [Round(rigid, self.result(DRIVE_TORQUE), np.zeros(len(GRID)), (), (0.0, 1.0))]
        share = OWN
        for count in range(1, ROUNDS + 1):
            ledger = self.ledger.named(f" in round {count}")
            try:
                found = self._round(name, rounds[-1], share * tolerance, ledger)
            except EffectError as error:
                raise _refused(f"round {count} has no answer, {error.message}", error) from error
            if found is None:
                return rigid
            rounds.append(found)
            left = _left(rounds)
            if left is None:
                continue
            feedback, beside = left
            sought = found.turn.sought
            errors = [each.bound.error + more for each, more in zip(sought, beside, strict=True)]
            worst = max(
                error / each.bound.scale for each, error in zip(sought, errors, strict=True)
            )
            if worst <= tolerance:
                rough = _rough_of([each.turn for each in rounds], errors[0])
                told = _told(feedback, found.turn, errors)
                return found.turn.fed_back(feedback, told, beside, rough)
            share *= 0.5 * tolerance / worst
        change = rounds[-1].change(rounds[-2])[0] / RPM
        raise _refused(f"after {ROUNDS} rounds the speed still changes by {change:.3g} rev/min")

    def _round(self, name: str, last: Round, tolerance: float, ledger: Ledger) -> Round | None:
        """What the effect `name` finds, to the `tolerance`, after the `last` round; None if nothing
        behind the train has mass.
        """
        subject = self.subject.turning(last.turn.course)
        known = {each: self.result(each) for each in self._elastic.received(VIBRATION)}
        train = Nodes(subject, self._elastic, ledger, known).result(VIBRATION)
        behind: ElasticTrain | None = train.behind
        if behind is None:
            return None
        passed = Passed(last.turn.course, subject.state.output, behind)
        force = passed.on_base(GRID, "right")[0]
        table = {**self.catalogue.tables[name], "tolerance": tolerance}
        catalogue = self.catalogue.with_table(name, table)
        try:
            unit = _loaded(last.drive, on_base(behind, np.ones(1)))
            step = tangent(passed, last.turn, last.drive.law, unit.law)
            more = step.ahead(force - last.force)
            drive = _loaded(self.result(DRIVE_TORQUE), passed.force(subject.state.smooth_angles))
            drive = _loaded(drive, on_base(behind, more))
            with np.errstate(divide="ignore", invalid="ignore"):  # in rounds that diverge
                nodes = Nodes(self.subject, catalogue, ledger, {DRIVE_TORQUE: drive})
                turn = nodes.beside(name, last.turn)
            off = _spread(turn, _loaded(drive, on_base(behind, np.full(1, behind.error))))
        except (StuckError, np.linalg.LinAlgError):
            raise EffectError("and no step can be taken") from None
        return Round(turn, drive, force + more, off, step.sizes)


def _spread(turn: Turning, other: DriveTorque) -> tuple[float, ...]:
    """How far what is sought may be off, to first order, if the torque law is off, in either sense
    at each cam angle, by as much as it differs from that of `other`.
    """
    mesh = turn.mesh
    shape = mesh.nodes.shape
    laws = laws_of(other.law, mesh.low, mesh.high)
    rows, others = (each.reshape(len(each), -1) for each in (mesh.laws, laws))
    slopes, off = turn.linearised(mesh.nodes.ravel(), rows, others)
    slopes = slopes.reshape(*shape, *slopes.shape[1:])
    found = spread(mesh.spans, slopes, np.abs(off).reshape(*shape, -1))
    return tuple(found.tolist())


def _refused(why: str, error: EffectError | None = None) -> EffectError:
    """That there is no fixed point, `why`, and which keys of the scene do without it."""
    return EffectError(
        f"no common steady state of the cam's speed and its elastic train was found: {why}; in"
        ' [state], output = "rigid" takes the train as rigid, and speed = "stated" keeps the speed'
        " of [cam]",
        finding="feedback",
        cam_angle=None if error is None else error.cam_angle,
    )


def _loaded(drive: DriveTorque, force: Force) -> DriveTorque:
    """`drive`, of a rigid train, with a `force` besides."""

    def law(phi: FloatArray, side: Side) -> FloatArray:
        return with_force(drive.law(phi, side), drive.contact.bearings, force, phi, side)

    return replace(drive, contact=drive.contact.beside(force), law=law)


def _left(rounds: Sequence[Round]) -> tuple[Feedback, list[float]] | None:
    """The state after `rounds`, the first one with a rigid train, and the errors of what is sought
    besides its own in the last one; None while a round changes the speed by more than its error.
    """
    if len(rounds) < 3:
        return None
    last = rounds[-1]
    before, now = rounds[-2].change(rounds[-3]), last.change(rounds[-2])
    error, off, residual = last.turn.sought[0].bound.error, last.off[0], float(now[0])
    # Differences below the error are none.
    ratio = residual / max(float(before[0]), error + off)
    if not residual <= (1.0 - ratio) * (error + off):
        return None
    more, whole = last.sizes
    d = (ratio * (residual + 2.0 * error) + more * error + whole * off) / (1.0 - ratio)
    follow = np.maximum(before / max(float(before[0]), error), now / max(residual, error))
    return Feedback(len(rounds) - 1, residual, ratio), [d, *(d * follow[1:]).tolist()]


def _told(feedback: Feedback, turn: Turning, errors: Sequence[float]) -> Finding:
    """How far the rounds have come."""
    change = feedback.residual / RPM
    known = listed(
        [
            f"{each.label.word} to {each.label.scale * error:.2g} {each.label.unit}"
            for each, error in zip(turn.sought, errors, strict=True)
        ]
    )
    sentence = (
        "the elastic train acts back on how the cam turns: the last of"
        f" {feedback.rounds} rounds from speed to vibration to torque to speed changes it by up to"
        f" {change:.2g} rev/min, each leaves {100.0 * feedback.ratio:.2g} % of a change, and it is"
        f" known, {known}; a disturbance decays as stated while the train keeps its force over the"
        " cam angle"
    )
    return Finding("feedback", "ok", sentence, change, unit="rev/min")


def _rough_of(turns: Sequence[Turning], error: float) -> Turning:
    """The last of `turns` whose speed differs by the `error` [rad/s] or more from the present one;
    its course on cells twice as long is farther from the fixed point.
    """
    now = turns[-1].sought[0].values
    for last in turns[-2::-1]:
        phi = np.concatenate((last.mesh.nodes.ravel(), turns[-1].mesh.nodes.ravel()))
        if np.max(np.abs(last.sought[0].values(phi) - now(phi))) >= error:
            return last
    return turns[0]
