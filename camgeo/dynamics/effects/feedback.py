"""How the cam turns before an elastic train: a fixed point.

The torque on the camshaft makes the speed of the cam, by its motor (`speed-fluctuation`) or by the
wind-up of its shaft (`camshaft-windup`), the speed the vibration of the train, the vibration the
force at the contact, and this the torque. With the force F over the cam angle the speed is S(F),
and at this the train has the force T(S(F)), which must be F. The first speed is that of a rigid
train. Each round computes T of the last speed, and the speed with this force and with what a
Newton step adds, c = T'S' (1 - T'S')^-1 (T - F), for the derivatives that are in
`camgeo.dynamics.effects.feedback`. Of the masses behind the train, the torque has the inertia at
the new speed and the difference from it at the former one, so that a stiff train changes little.

Rounds are a map of speeds, omega -> H(omega). Where it contracts, |H(a) - H(b)| <= q |a - b| with
q < 1, there is one fixed point (Banach). From an exact round whose change is r = |H(omega) - omega|
it is no farther than q r / (1 - q). In a round the speed has an error e, and the force one from
which an error f of the speed follows (`camgeo.dynamics.effects.feedback`). Both are passed on, by
the Newton step as (1 - S'T')^-1 = P has it; so a speed is off by no more than

    e + (q (r + 2 e) + |P - 1| e + |P| f) / (1 - q) = e + d.

What else is solved for, the wind-up, changes by no more than p times as much as the speed, and is
off by no more than its own error and p d. All are the largest over the turn. q and p are estimated,
by the ratios between the last rounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.bearing_friction import StuckError, add_force
from camgeo.dynamics.effects.effect import TOLERANCE, Quantity, Subject
from camgeo.dynamics.effects.forces import ElasticTrain, Force, unmoved
from camgeo.dynamics.effects.graph import Nodes
from camgeo.dynamics.effects.registry import Catalogue
from camgeo.dynamics.effects.results import DRIVE_TORQUE, VIBRATION, DriveTorque, Feedback, Turning
from camgeo.dynamics.effects.shaft import Mesh, collocation
from camgeo.errors import EffectError
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.time_course import TimeCourse
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import BoolArray, FloatArray, Side, read_only
from camgeo.units import RPM, TURN, listed

ROUNDS: Final = 20
"""Number of rounds after which the iteration counts as one that does not contract."""

ROUND_SHARE: Final = 0.25
"""Share of the tolerance for what each round finds; the rest is for the rounds that are left."""


@dataclass(frozen=True, slots=True, eq=False)
class FeedbackRound:
    """A round of the fixed-point iteration.

    Attributes
    ----------
    turn : how the cam turns.
    drive : what is turned, with the force that the round takes for that of the train.
    force : this force [N or N mm] on the base of the train, at cam angles of an even grid.
    train_errors : the errors of `Turning.unknowns` that follow from that of the train.
    sizes : |P - 1| and |P| of the step.
    """

    turn: Turning
    drive: DriveTorque
    force: FloatArray
    train_errors: tuple[float, ...]
    sizes: tuple[float, float]

    def change(self, other: FeedbackRound) -> FloatArray:
        """(d,) the largest differences of the unknowns from those of the `other` round."""
        phi = np.concatenate(
            [feedback_round.turn.turn.mesh.nodes.ravel() for feedback_round in (self, other)]
        )
        both = zip(self.turn.unknowns, other.turn.unknowns, strict=True)
        return np.array([np.max(np.abs(a.values(phi) - b.values(phi))) for a, b in both])


class FeedbackNodes(Nodes):
    """The effects that find how the cam turns, with a rigid train, and their fixed point with the
    elastic train.

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

    def _stated(self, name: str, result: Any) -> Any:
        stated = super()._stated(name, result)
        return self._steady(name, stated) if name == self.catalogue.finder else stated

    def _steady(self, name: str, rigid: Turning) -> Turning:
        """The fixed point of the effect `name`; `rigid`, the answer of a rigid train, if nothing
        behind it has mass.

        Raises
        ------
        EffectError
            "feedback", if the iteration does not contract; and as the effects of a round.
        """
        tolerance = float(self.catalogue.tables[name].get("tolerance", TOLERANCE))
        rounds = [
            # Round 0 is that of the rigid train: no force of its own, and P = 1.
            FeedbackRound(rigid, self.result(DRIVE_TORQUE), np.zeros(len(GRID)), (), (0.0, 1.0))
        ]
        share = ROUND_SHARE
        for count in range(1, ROUNDS + 1):
            ledger = self.ledger.named(f" in round {count}")
            try:
                latest = self._round(name, rounds[-1], share * tolerance, ledger)
            except EffectError as error:
                raise _feedback_error(f"round {count} failed: {error.message}", error) from error
            if latest is None:
                return rigid
            rounds.append(latest)
            left = _remaining_errors(rounds)
            if left is None:
                continue
            feedback, added_errors = left
            unknowns = latest.turn.unknowns
            errors = [
                unknown.bound.error + more
                for unknown, more in zip(unknowns, added_errors, strict=True)
            ]
            worst = max(
                error / unknown.bound.scale for unknown, error in zip(unknowns, errors, strict=True)
            )
            if worst <= tolerance:
                rough = _rough_turn([past.turn for past in rounds], errors[0])
                finding = _feedback_finding(feedback, latest.turn, errors)
                return latest.turn.fed_back(feedback, finding, added_errors, rough)
            # The error of a round itself is the one that can be chosen; half of it is reserve.
            share *= 0.5 * tolerance / worst
        change = rounds[-1].change(rounds[-2])[0] / RPM
        raise _feedback_error(
            f"after {ROUNDS} rounds the speed still changes by {change:.3g} rev/min"
        )

    def _round(
        self, name: str, last: FeedbackRound, tolerance: float, ledger: Ledger
    ) -> FeedbackRound | None:
        """What the effect `name` finds, to the `tolerance`, after the `last` round; None if nothing
        behind the train has mass.
        """
        subject = self.subject.turning(last.turn.course)
        known = {key: self.result(key) for key in self._elastic.received(VIBRATION)}
        train = Nodes(subject, self._elastic, ledger, known).result(VIBRATION)
        behind: ElasticTrain | None = train.behind
        if behind is None:
            return None
        passed = TrainForce(last.turn.course, subject.state.output, behind)
        force = passed.on_base(GRID, "right")[0]
        table = {**self.catalogue.tables[name], "tolerance": tolerance}
        catalogue = self.catalogue.with_table(name, table)
        try:
            unit = _loaded(last.drive, base_force(behind, np.ones(1)))
            step = tangent(passed, last.turn, last.drive.law, unit.law)
            more = step.ahead(force - last.force)
            drive = _loaded(self.result(DRIVE_TORQUE), passed.force(subject.state.smooth_angles))
            drive = _loaded(drive, base_force(behind, more))
            with np.errstate(divide="ignore", invalid="ignore"):  # in rounds that diverge
                nodes = Nodes(self.subject, catalogue, ledger, {DRIVE_TORQUE: drive})
                turn = nodes.result_near(name, last.turn)
            errors = _unknown_errors(
                turn, _loaded(drive, base_force(behind, np.full(1, behind.error)))
            )
        except (StuckError, np.linalg.LinAlgError):
            raise EffectError("no Newton step can be taken") from None
        return FeedbackRound(turn, drive, force + more, errors, step.sizes)


def _unknown_errors(turn: Turning, other: DriveTorque) -> tuple[float, ...]:
    """Largest errors of the unknowns, to first order, if the torque law is off at each cam angle,
    in either direction, by its difference from the law of `other`.
    """
    mesh = turn.turn.mesh
    shape = mesh.nodes.shape
    laws = Mesh.with_law(other.law, mesh.low, mesh.high).laws
    rows, others = (law_rows.reshape(len(law_rows), -1) for law_rows in (mesh.laws, laws))
    slopes, differences = turn.turn.linearised(mesh.nodes.ravel(), rows, others)
    slopes = slopes.reshape(*shape, *slopes.shape[1:])
    errors = spread(mesh.spans, slopes, np.abs(differences).reshape(*shape, -1))
    return tuple(errors.tolist())


def _feedback_error(why: str, error: EffectError | None = None) -> EffectError:
    """The error that no fixed point was found, for the reason `why`, with the keys of the scene
    that avoid the search.
    """
    return EffectError(
        f"no common steady state of the cam's speed and its elastic train was found: {why}; in"
        ' [state], output = "rigid" takes the train as rigid, and speed = "stated" keeps the speed'
        " of [cam]",
        finding="feedback",
        cam_angle=None if error is None else error.cam_angle,
    )


def _loaded(drive: DriveTorque, force: Force) -> DriveTorque:
    """`drive`, of a rigid train, with one more `force`."""

    def law(phi: FloatArray, side: Side) -> FloatArray:
        return add_force(drive.law(phi, side), drive.contact.bearings, force, phi, side)

    return replace(drive, contact=drive.contact.with_force(force), law=law)


def _remaining_errors(rounds: Sequence[FeedbackRound]) -> tuple[Feedback, list[float]] | None:
    """The state after `rounds`, the first one with a rigid train, and the errors of the unknowns
    besides their own in the last one; None while a round changes the speed by more than its error.
    """
    if len(rounds) < 3:
        return None
    last = rounds[-1]
    previous, now = rounds[-2].change(rounds[-3]), last.change(rounds[-2])
    error, train_error, residual = (
        last.turn.unknowns[0].bound.error,
        last.train_errors[0],
        float(now[0]),
    )
    # Differences below the error are none.
    ratio = residual / max(float(previous[0]), error + train_error)
    # The changes still to come are a geometric series, residual / (1 - ratio) in sum.
    if not residual <= (1.0 - ratio) * (error + train_error):
        return None
    more, whole = last.sizes
    d = (ratio * (residual + 2.0 * error) + more * error + whole * train_error) / (1.0 - ratio)
    # p of the module: what else is solved for, by how much it changes with the speed.
    follow = np.maximum(previous / max(float(previous[0]), error), now / max(residual, error))
    return Feedback(len(rounds) - 1, residual, ratio), [d, *(d * follow[1:]).tolist()]


def _feedback_finding(feedback: Feedback, turn: Turning, errors: Sequence[float]) -> Finding:
    """The finding on how far the rounds have converged."""
    change = feedback.residual / RPM
    known = listed(
        [
            f"{unknown.label.scale * error:.2g} {unknown.label.unit} of the {unknown.label.word}"
            for unknown, error in zip(turn.unknowns, errors, strict=True)
        ]
    )
    sentence = (
        "the elastic train acts back on the rotation of the cam: the last of"
        f" {feedback.rounds} rounds (speed, vibration, torque, speed) changes the speed by up to"
        f" {change:.2g} rev/min, each round leaves {100.0 * feedback.ratio:.2g} % of a change, and"
        f" the errors are {known}; the stated decay of a disturbance holds while the train keeps"
        " its force over the cam angle"
    )
    return Finding("feedback", "ok", sentence, change, unit="rev/min")


def _rough_turn(turns: Sequence[Turning], error: float) -> Turning:
    """The last of `turns` whose speed differs by the `error` [rad/s] or more from the present one;
    its course on cells twice as long is farther from the fixed point.
    """
    now = turns[-1].unknowns[0].values
    for last in turns[-2::-1]:
        phi = np.concatenate((last.turn.mesh.nodes.ravel(), turns[-1].turn.mesh.nodes.ravel()))
        if np.max(np.abs(last.unknowns[0].values(phi) - now(phi))) >= error:
            return last
    return turns[0]


# -- tangent --------------------------------------------------------------------------------------
# How cam and elastic train change each other, to first order: what a Newton step needs.
#
# S is the speed omega over the cam angle that follows from a force F of the train, T the force that
# follows from a speed (`camgeo.dynamics.effects.feedback`). Their derivatives are matrices here, on
# an even grid of cam angles, where D differentiates trigonometric polynomials (Trefethen, Spectral
# Methods in MATLAB, chapter 3). A mode of the train has omega du/dphi = lambda u - y'', so that
# with changes d
#
#     (omega D - lambda) du = -dy'' - (du/dphi) domega,    dy'' = 2 s'' omega domega + s' dalpha,
#
# with dalpha = D (omega domega); and S' follows from the linear equations of the turn
# (`SteadyTurn.linearised`). They are as accurate as the grid: what follows from them is a guess,
# which never decides an error but by how large it is.


ANGLES: Final = 383
"""Cam angles of the grid, an odd number."""

GRID: Final[FloatArray] = read_only(np.arange(ANGLES, dtype=np.float64) * np.float64(TURN / ANGLES))
"""(n,) cam angles [rad]."""

PER_PERIOD: Final = 8.0
"""Cam angles per period of a mode that the grid resolves, at least."""

SHARPNESS: Final = 36.0
"""Exponent of the filter of order 8 at the last harmonic: it leaves a rounding of that (Vandeven,
1991, on filters of spectral methods)."""


@dataclass(frozen=True, eq=False)
class Tangent:
    """The derivatives at some speed.

    Attributes
    ----------
    follow : (n, n) T' [N or N mm per rad/s].
    answer : (n, n) S'.
    """

    follow: FloatArray
    answer: FloatArray

    @cached_property
    def _whole(self) -> FloatArray:
        """(n, n) P = (1 - S'T')^-1."""
        return np.asarray(np.linalg.inv(np.eye(len(self.follow)) - self.answer @ self.follow))

    def ahead(self, missing: FloatArray) -> FloatArray:
        """(n,) what is still missing of the force [N or N mm] once what is `missing` (n,) is added,
        and what follows from it: T'S' (1 - T'S')^-1 = T' P S' of it.
        """
        return np.asarray(self.follow @ (self._whole @ (self.answer @ missing)))

    @property
    def sizes(self) -> tuple[float, float]:
        """The largest changes of the speed per unit of a change that a round makes by itself, in
        addition to this and in sum: the norms of P - 1 and of P.
        """
        one = np.eye(len(self.follow))
        norms = [
            np.max(np.sum(np.abs(matrix), axis=1)) for matrix in (self._whole - one, self._whole)
        ]
        return float(norms[0]), float(norms[1])


@dataclass(frozen=True, slots=True, eq=False)
class TrainForce:
    """The force that a train passes on, in place of that of a rigid one.

    Either the whole of it is that at `course`; then masses that it isolates do not take part in
    what is solved for. Or the mass behind it is accelerated at the speed that is solved for, and
    the difference is that at `course`: for a train so stiff that the grid does not resolve it.

    Attributes
    ----------
    motion : y of its base.
    behind : the train, with the cam turning as `course` says.
    """

    course: TimeCourse
    motion: Motion
    behind: ElasticTrain

    @property
    def resolved(self) -> BoolArray:
        """(m,) whether the grid resolves each of the modes."""
        behind = self.behind
        periods = behind.train.rates.imag * (behind.response.base.period / TURN)
        return np.asarray(PER_PERIOD * periods <= ANGLES)

    @property
    def accelerated_mass(self) -> float:
        """The mass [t or t mm^2] that is accelerated at the speed that is solved for."""
        return 0.0 if np.all(self.resolved) else self.behind.mass

    def on_base(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) c0 to c3 on the base, without a load on the output, which a rigid train has
        there.
        """
        behind = self.behind
        coefficients = np.zeros((4, len(phi)))
        coefficients[0] = -behind.pushes(behind.response, phi, side)
        if behind.load is not None:
            coefficients -= behind.load.coefficients(phi, side)
        if self.accelerated_mass:
            coefficients[0] += self.accelerated_mass * behind.base(phi, side)[2]
        else:
            # y'' = y_2 omega^2 + y_1 alpha: c2 takes the second derivative, c3 the first one.
            coefficients[2:] = behind.mass * self.motion.jet(phi, side, 2)[2:0:-1]
        return coefficients

    def force(self, smooth: FloatArray) -> Force:
        """The force, which is smooth between the angles `smooth` (m,) [rad]."""

        def on_follower(phi: FloatArray, side: Side) -> FloatArray:
            return self.on_base(phi, side) * self.behind.per_lift(phi, side)

        load, cuts = self.behind.load, self.behind.edges(smooth)
        borders = np.empty(0) if load is None else load.borders
        return Force("the elastic train", on_follower, borders=borders, cuts=cuts, far=self.on_base)


def tangent(passed: TrainForce, turn: Turning, law: Quantity, other: Quantity) -> Tangent:
    """The derivatives where the train passes on what is `passed`, and the cam turns as `turn` has
    found.

    Parameters
    ----------
    law : the torque law of `turn`.
    other : the law with a unit more of force on the base.
    """
    derive = _derivative()
    return Tangent(_follow(passed, derive), _answer(turn, law, other, derive))


def _derivative() -> FloatArray:
    """(n, n) D."""
    k = np.arange(ANGLES)
    difference = k[:, np.newaxis] - k
    with np.errstate(divide="ignore"):
        # Trigonometric differentiation on an odd number of points; the diagonal is set below.
        matrix = 0.5 * (-1.0) ** difference / np.sin(difference * (0.5 * TURN / ANGLES))
    matrix[k, k] = 0.0
    return np.asarray(matrix)


def _follow(passed: TrainForce, derive: FloatArray) -> FloatArray:
    behind, phi = passed.behind, GRID
    response, reading = behind.response, behind.train.force(0)
    omega = passed.course.rates(phi)[0]
    lift, velocity, _ = behind.base(phi, "right")
    _, first, second = passed.motion.jet(phi, "right", 2)[:3]
    speeding = derive * omega  # alpha is the derivative of omega^2 / 2
    # The change of y'' = s'' omega^2 + s' alpha by the speed.
    pushed = np.diag(2.0 * second * omega) + first[:, np.newaxis] * speeding
    time = passed.course.time(phi) - passed.course.time(np.zeros(1))
    force = passed.accelerated_mass * pushed - np.diag(reading.slope * first)
    rates, weights = behind.train.rates, reading.weights
    modes = zip(response.modes, rates, weights, passed.resolved, strict=True)
    for mode, rate, weight, resolved in modes:
        driven = -pushed
        if resolved:  # of others only the forcing is known here
            u = mode.values(time, "right")
            if response.forcing.soft:  # then it is driven by y
                u = -(velocity + rate * lift + rate**2 * u)
            driven = driven - np.diag(derive @ u)
        operator = omega[:, np.newaxis] * derive - rate * np.eye(ANGLES)
        force = force - (weight * np.linalg.solve(operator, driven)).real
    return np.asarray(force)


def _answer(turn: Turning, law: Quantity, other: Quantity, derive: FloatArray) -> FloatArray:
    slopes, differences = turn.turn.linearised(GRID, law(GRID, "right"), other(GRID, "right"))
    count, size = differences.shape
    index = np.arange(count)
    matrix = np.zeros((size, count, size, count))
    sides = np.zeros((size, count, count))
    for row in range(size):
        # D on the diagonal blocks; at each angle the slopes couple the d numbers of the state.
        matrix[row, :, row, :] = derive
        sides[row, index, index] = differences[:, row]
        for column in range(size):
            matrix[row, index, column, index] -= slopes[:, row, column]
    solved = np.linalg.solve(matrix.reshape(size * count, -1), sides.reshape(size * count, -1))
    return np.asarray(solved[:count])


def base_force(behind: ElasticTrain, values: FloatArray) -> Force:
    """A force on the base of the train with the `values` [N or N mm] on an even grid, smooth
    between.
    """
    count = len(values)
    series = np.fft.rfft(values) / count
    # The last harmonics would make the series swing at jumps.
    series *= np.exp(-SHARPNESS * (2.0 * np.arange(len(series)) / count) ** 8)

    def far(phi: FloatArray, _: Side) -> FloatArray:
        z = np.exp(1j * phi)
        total = np.zeros(len(phi), dtype=np.complex128)
        # Horner's scheme, from the highest harmonic down to the first one.
        for coefficient in series[:0:-1]:
            total = (total + coefficient) * z
        # The negative harmonics of a real function are the conjugates: twice the real part.
        return np.asarray(series[0].real + 2.0 * total.real)

    def force(phi: FloatArray, side: Side) -> FloatArray:
        return far(phi, side) * behind.per_lift(phi, side)

    return Force("the elastic train, ahead", unmoved(force), far=unmoved(far))


# -- spread ---------------------------------------------------------------------------------------
# How far the steady state of a camshaft is off if its rates are, to first order.
#
# The state x over the cam angle, of one or two numbers, obeys x' = f(x) and repeats itself after
# the turn. With rates off by d it is off by dx, with dx' = f_x dx + d, and dx repeats itself too.
# Of d only the size is known at each cam angle. Over a cell the collocation equations give dx at
# the nodes from that at the start, by H, and from the d at each node, whose parts are added by
# their sizes.
#
# From cell to cell an orthonormal basis Q is carried along, H Q = Q' R with R upper triangular, and
# the parts b of each cell pass on by the sizes of the elements of R: s' = |R| s + |Q'^T| b. This
# keeps what decays apart from what lasts, and where the state swings, its phase does not matter.
# With one number little is lost. With the s of a turn from 0, and its matrix M, the periodic dx at
# cam angle 0 is at most |(1 - M)^-1 Q| s, and that of all other places follows from there in the
# same way.


def spread(spans: FloatArray, slopes: FloatArray, disturbances: FloatArray) -> FloatArray:
    """(d,) the largest |dx| at the nodes.

    Parameters
    ----------
    spans : (m,) lengths of the cells of the turn [rad].
    slopes : (m, n, d, d) f_x at their nodes.
    disturbances : (m, n, d) |d| there.
    """
    count, nodes, size = disturbances.shape
    scales = _balanced(slopes)
    slopes, disturbances = slopes * scales[:, np.newaxis] / scales, disturbances * scales
    inner = spans[:, np.newaxis, np.newaxis] * collocation().integral
    # From component e at node q to component d at node p: (m, p, d, q, e), as one matrix a cell.
    coupled = inner[:, :, np.newaxis, :, np.newaxis] * slopes.swapaxes(1, 2)[:, np.newaxis]
    matrix = np.eye(nodes * size) - coupled.reshape(count, nodes * size, nodes * size)
    starts = np.broadcast_to(np.tile(np.eye(size), (nodes, 1)), (count, nodes * size, size))
    # A disturbance of component e at node q enters component e alone, at all nodes p after it.
    parts = np.einsum("mpq,mqe,de->mpdqe", inner, disturbances, np.eye(size))
    sides = np.concatenate((starts, parts.reshape(matrix.shape)), axis=2)
    solved = np.linalg.solve(matrix, sides).reshape(count, nodes, size, -1)
    passed = solved[..., :size]
    contributions = np.sum(np.abs(solved[..., size:]), axis=-1)

    def turned(first: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(m, d) at most |dx| at the starts of the cells, Q and s at the end; from |dx| `first`."""
        basis, bound, bounds = np.eye(size), first, np.empty((count, size))
        for cell in range(count):
            bounds[cell] = np.abs(basis) @ bound
            basis, factor = np.linalg.qr(passed[cell, -1] @ basis)
            # Radau's last node is the end of the cell.
            bound = np.abs(factor) @ bound + np.abs(basis.T) @ contributions[cell, -1]
        return bounds, basis, bound

    _, basis, bound = turned(np.zeros(size))
    whole = np.eye(size)
    for cell_map in passed[:, -1]:
        whole = cell_map @ whole
    first = np.abs(np.linalg.solve(np.eye(size) - whole, basis)) @ bound
    at_starts = turned(first)[0]
    everywhere = np.einsum("mndk,mk->mnd", np.abs(passed), at_starts) + contributions
    return np.asarray(np.max(everywhere, axis=(0, 1)) / scales)


def _balanced(slopes: FloatArray) -> FloatArray:
    """(d,) factors that bring the d numbers of a state that swings to one size."""
    across = np.mean(np.abs(slopes), axis=(0, 1))
    if len(across) == 1 or not across[0, 1] * across[1, 0] > 0.0:
        return np.ones(len(across))
    # With this scale both couplings of the swing are equally large.
    return np.array([1.0, float(np.sqrt(across[0, 1] / across[1, 0]))])
