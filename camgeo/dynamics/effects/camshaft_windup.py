"""Wind-up of a camshaft: the angle by which the cam lags behind its drive, over a turn.

J omega domega/dphi = M - T(phi, omega, alpha), where the shaft carries M = k w + c (Omega - omega)
with the wind-up w = integral of (Omega - omega) dt: the equation of motion of a rigid cam at the
end of a massless shaft, whose other end turns at the constant speed Omega, with the torque T of the
cam that includes the inertia of the follower (Koster, Vibrations of Cam Mechanisms, and Norton, Cam
Design and Manufacturing Handbook, chapter on models of cam-follower systems, treat such shafts).
The solution is the motion that repeats after each turn of the drive. With k towards infinity w
becomes T / k.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Self

import numpy as np

from camgeo.check.finding import Finding, Severity, limit_finding
from camgeo.dynamics.effects.bearing_friction import StuckError, linear_law
from camgeo.dynamics.effects.contact import lost_contact, ranges_below
from camgeo.dynamics.effects.effect import Bound, Column, Quantity, Request
from camgeo.dynamics.effects.forces import smooth_edges
from camgeo.dynamics.effects.results import DRIVE_TORQUE, Turning, Unknown
from camgeo.dynamics.effects.shaft import (
    EPS,
    FINEST,
    INTERIOR_FACTOR,
    INTERPOLATION_ERROR,
    KEEP,
    LONGEST,
    NODES,
    ROUGH,
    ROUNDINGS,
    DoubleMesh,
    Mesh,
    NoConvergenceError,
    Shaft,
    State,
    collocation,
    double_mesh,
    interleaved,
    jamming,
    legendre,
    refuse_shocks,
    steady_course,
    switches,
)
from camgeo.dynamics.effects.tables import ElasticShaft
from camgeo.dynamics.effects.wording import (
    N_M,
    Label,
    extreme_findings,
    over_ranges,
    placed,
    remaining_share,
    tolerance_error,
)
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.units import RPM, TURN

REVERSED: Final = 1e-3
"""A torque against that of the drive by less than this share of the largest does not count: a shaft
swings on a little after each move."""

LASTING: Final = 1e-6
"""Without damping the share of a disturbance that is left after a turn is 1, to this accuracy."""


@dataclass(frozen=True, slots=True, eq=False)
class CamshaftWindup(Turning):
    """The steady state of a cam on an elastic camshaft.

    Attributes
    ----------
    turn : speed and wind-up over the cam angle.
    """

    turn: WindupTurn

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """See `Turning`."""
        speed, windup = _bounds(self.turn)
        return (
            Unknown(Label("speed", "rev/min", 1.0 / RPM), self.turn.omega, speed),
            Unknown(Label("wind-up", "deg", math.degrees(1.0)), self.turn.windup, windup),
        )

    def with_added_errors(self, added_errors: Sequence[float], rough: Self) -> Self:
        """See `Turning`."""
        turn = replace(
            self.turn,
            speed_error=self.turn.speed_error + added_errors[0],
            windup_error=self.turn.windup_error + added_errors[1],
            multiplier_error=self.turn.multiplier_error
            + abs(self.turn.multiplier - rough.turn.multiplier),
        )
        return replace(self, turn=turn, errors=figure_errors(turn))


def compute(request: Request[ElasticShaft]) -> CamshaftWindup:
    """The steady state, with speed and wind-up to the tolerance.

    Raises
    ------
    EffectError
        "shock", if the follower's velocity jumps; and as `solve`.
    """
    subject, data = request.subject, request.data
    drive = request.results[DRIVE_TORQUE]
    law, contact = drive.law, drive.contact
    edges = smooth_edges(subject.state.smooth_angles, contact.lasting)
    refuse_shocks(subject, law)
    speed = float(request.course.rates(np.zeros(1))[0, 0])
    cam = CamOnShaft(data, speed)
    near = None if request.near is None else request.near.turn
    turn, edges = _accurate(cam, law, edges, request.tolerance, near)
    assert turn.rough is not None  # only that one has none

    def omega(phi: FloatArray, _: Side) -> FloatArray:
        return turn.omega(phi)

    def windup(phi: FloatArray, _: Side) -> FloatArray:
        return turn.windup(phi) * math.degrees(1.0)

    def torque(phi: FloatArray, _: Side) -> FloatArray:
        shaft, y = turn.driven(phi)
        return N_M * shaft.motor.torque(np.sqrt(2.0 * y))[0]

    def alpha(phi: FloatArray, side: Side) -> FloatArray:
        shaft, y = turn.driven(phi)
        return shaft.rate(law(phi, side), y)[0]

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        rates = np.stack((turn.omega(phi), alpha(phi, side)))
        return contact.normal_at_rates(phi, side, rates)

    windups, torques, speeds = (
        piecewise_extremes(quantity, edges) for quantity in (windup, torque, omega)
    )
    speeds = Extremes(*(Extreme(end.value / RPM, end.place) for end in _ends(speeds)))
    largest = max(_ends(windups), key=lambda end: abs(end.value))
    span = windups.highest.value - windups.lowest.value
    limit = None if data.limit is None else math.degrees(data.limit)
    findings = (
        limit_finding(
            "windup",
            f"the cam deviates from the angle of its drive by up to {abs(largest.value):.6g} deg",
            abs(largest.value), limit, "deg", largest.place,
        ),
        *extreme_findings("windup", "wind-up of the camshaft", windups, "deg"),
        Finding(
            "windup-range",
            "ok",
            f"over a turn the wind-up of the camshaft varies by {span:.6g} deg",
            span,
            unit="deg",
        ),
        *extreme_findings("shaft-torque", "torque in the camshaft", torques, "N m"),
        *_reversal(torque, edges, torques),
        *extreme_findings("speed", "speed of the cam", speeds, "rev/min"),
        *_swinging(turn),
    )  # fmt: skip
    return CamshaftWindup(
        turn=turn,
        course=steady_course(turn, alpha, edges),
        rough_course=steady_course(turn.rough, alpha, edges),
        findings=findings,
        lost_contact=lost_contact(subject, normal, piecewise_extremes(normal, edges), edges, None),
        columns=(
            Column("windup", "deg", windup, limit),
            Column("shaft torque", "N m", torque),
            Column("cam speed", "rev/min", lambda phi, side: omega(phi, side) / RPM),
        ),
        errors=figure_errors(turn),
    )


def _accurate(
    cam: CamOnShaft, law: Quantity, edges: FloatArray, tolerance: float, near: WindupTurn | None
) -> tuple[WindupTurn, FloatArray]:
    """The steady state as `solve` finds it, with all figures to the tolerance unless rounding of
    the speed is larger.
    """
    solution = solve(cam, law, edges, tolerance, near)
    worst = max(bound.share for bound in figure_errors(solution[0]).values())
    if worst > tolerance:
        with suppress(EffectError):
            # The errors of the figures are proportional to that of the solution; half of it is
            # reserve.
            finer = max(0.5 * tolerance * tolerance / worst, FINEST)
            return solve(cam, law, edges, finer, solution[0])
    return solution


def _ends(ends: Extremes) -> tuple[Extreme, Extreme]:
    return ends.lowest, ends.highest


def _reversal(torque: Quantity, edges: FloatArray, ends: Extremes) -> Iterator[Finding]:
    """A warning where the `torque` in the shaft reverses; none if it does not."""
    least = -REVERSED * ends.magnitude
    if ends.lowest.value >= least or ends.highest.value <= 0.0:
        return
    ranges = ranges_below(torque, edges, least, ends.lowest)
    yield placed(
        "torque-reversal",
        "the cam drives its camshaft"
        f" {over_ranges([(stretch.start, stretch.end) for stretch in ranges])}: where"
        " the torque in it reverses, play between drive and cam is crossed, with impacts that are"
        " not included in any value",
        ends.lowest,
        "N m",
        0.0,
        "warning",
    )


def _swinging(turn: WindupTurn) -> Iterator[Finding]:
    """Findings on the natural frequency of the cam on its shaft, and on whether it settles into the
    steady state.
    """
    natural, left = turn.cam.shaft.natural_frequency, 100.0 * turn.multiplier
    yield Finding(
        "natural-frequency",
        "ok",
        f"natural frequency of the cam without its follower on the camshaft {natural / TURN:.6g}"
        f" Hz, {natural / turn.cam.speed:.5g} times the speed of its drive",
        natural / TURN,
        unit="Hz",
    )
    sentence = f"{remaining_share(turn.multiplier)} of a disturbance is left after a turn"
    severity: Severity = "ok"
    if abs(turn.multiplier - 1.0) <= LASTING:
        severity = "warning"
        sentence += ": without damping, the cam does not come to this steady state by itself"
    elif turn.multiplier > 1.0:
        severity = "broken"
        sentence += ": the steady state is unstable, and the cam does not stay in it"
    yield Finding("settling", severity, sentence, left, unit="%")


def _bounds(turn: WindupTurn) -> tuple[Bound, Bound]:
    """The errors of speed [rad/s] and wind-up [rad]."""
    speed, largest = turn.cam.speed, turn.pair.largest_windup
    return (
        Bound(turn.speed_error + INTERPOLATION_ERROR * speed, speed),
        Bound(turn.windup_error + INTERPOLATION_ERROR * largest, largest),
    )


def figure_errors(turn: WindupTurn) -> dict[str, Bound]:
    """The errors by the names of findings and columns."""
    shaft, (speed, windup) = turn.cam.shaft, _bounds(turn)
    torque = Bound(
        shaft.stiffness * windup.error + shaft.viscosity * speed.error,
        shaft.stiffness * windup.scale,
    )
    torques = ("shaft torque", "largest-shaft-torque", "smallest-shaft-torque", "torque-reversal")
    windups = ("windup", "largest-windup", "smallest-windup")
    speeds = ("cam speed", "largest-speed", "smallest-speed")
    left = Bound(turn.multiplier_error, max(turn.multiplier, 1.0))
    return {
        "settling": left.times(100.0),
        **dict.fromkeys(windups, windup.times(math.degrees(1.0))),
        "windup-range": Bound(2.0 * windup.error, windup.scale).times(math.degrees(1.0)),
        **dict.fromkeys(torques, torque.times(N_M)),
        **dict.fromkeys(speeds, speed.times(1.0 / RPM)),
    }


# -- solve ----------------------------------------------------------------------------------------
# The steady state of a cam at the end of an elastic shaft, and its obstacles.


PHASE: Final = 4.0
"""Largest angle [rad] by which the cam swings on its shaft within an initial cell: a longer one
would damp the swing, alike on the halves of the cell, which would not show it."""

SWINGS: Final = 4.0
"""Largest number of swings on the shaft within a piece in which extremes are searched for."""

STIFFEST: Final = 4000.0
"""Largest natural frequency, in speeds of the drive."""

STIFFER: Final = (100.0, 30.0, 10.0, 5.0, 3.0, 2.0, 1.5, 1.2)
"""Shafts stiffer by these factors, by whose motions Newton's method is led to that of a soft one.
"""

SPURIOUS: Final = 0.1
"""A solution that is off by this share, however short the cells, is none."""


def solve(
    cam: CamOnShaft, law: Quantity, edges: FloatArray, tolerance: float, near: WindupTurn | None
) -> tuple[WindupTurn, FloatArray]:
    """The steady state, of which one that is `near` may be known, with speed and wind-up to the
    tolerance, and cam angles (k,) [rad] from 0 to 2 pi between which both are smooth and swing no
    more than `SWINGS` times.

    Parameters
    ----------
    law : the torque law of the cam, smooth between `edges` (k,) [rad].

    Raises
    ------
    EffectError
        "stiff-shaft", if it swings too fast to be followed; "soft-shaft", if there is no steady
        state in which the cam always turns forward; "jamming", if no acceleration satisfies the
        equation of motion with friction; and if the tolerance cannot be reached.
    """
    ratio = cam.shaft.natural_frequency / cam.speed
    if ratio > STIFFEST:
        raise EffectError(
            f"the natural frequency of the cam on its shaft is {ratio:.6g} times the speed of the"
            f" drive; allowed: up to {STIFFEST:g} times. So stiff a shaft follows the torque at"
            " once: its wind-up is the drive torque divided by the stiffness",
            finding="stiff-shaft",
            value=ratio,
            limit=STIFFEST,
        )
    turn = near
    if turn is None:
        turn = _solved(cam, law, edges, max(ROUGH[0], tolerance), None)
    for rough in ROUGH:
        kinks = switches(law, edges, turn.mesh.laws, turn.driven)
        if not len(kinks):
            break
        edges = merged(np.concatenate((edges, kinks)))
        turn = _solved(cam, law, edges, max(rough, tolerance), turn)
    turn = _solved(cam, law, edges, tolerance, turn)
    # The cam may swing often between two edges, but the search for extremes needs few in a piece.
    pieces = np.linspace(0.0, TURN, max(math.ceil(ratio / SWINGS), 1) + 1)
    return turn, merged(np.concatenate((edges, pieces)))


def _solved(
    cam: CamOnShaft, law: Quantity, edges: FloatArray, tolerance: float, near: WindupTurn | None
) -> WindupTurn:
    longest = min(LONGEST, PHASE * cam.speed / cam.shaft.natural_frequency)
    mesh = double_mesh(law, edges, longest)
    try:
        return periodic(cam, law, mesh, _guess(cam, mesh, tolerance, near), tolerance)
    except StuckError as error:
        raise jamming(cam.shaft.moment_of_inertia, mesh.fine) from error
    except NoConvergenceError as error:
        if error.reached is None or not error.reached < SPURIOUS:
            raise _too_soft(cam) from error
        raise tolerance_error("the wind-up", error.reached, "the largest one", tolerance) from error


def _guess(
    cam: CamOnShaft, mesh: DoubleMesh, tolerance: float, near: WindupTurn | None
) -> WindupState:
    """Near the solution on the coarse mesh: by way of stiffer shafts, if it must be."""
    coarse = mesh.coarse
    try:
        first = _static(cam, coarse) if near is None else near.resample(coarse)
        return newton(cam, coarse, first, tolerance)[0]
    except (NoConvergenceError, StuckError):
        # Far from the solution Newton's method fails. That of a stiff shaft is nearly static, and
        # is followed to the actual stiffness.
        pair = _static(cam.stiffened(STIFFER[0]), coarse)
        for factor in (*STIFFER, 1.0):
            pair = newton(cam.stiffened(factor), coarse, pair, tolerance)[0]
        return pair


def _static(cam: CamOnShaft, mesh: Mesh) -> WindupState:
    """The cam at the speed of the drive, with the shaft wound up by the torque at this speed."""
    c0, c1, c2, _, ahead, behind = linear_law(mesh.laws, cam.speed, 0.0)
    force = c0 + cam.speed * (c1 + cam.speed * c2)
    torque = np.where(force == 0.0, 0.0, force * np.where(force > 0.0, ahead, behind))
    if np.any(np.isnan(torque)):
        raise StuckError
    nodes = np.zeros((*torque.shape, 2))
    nodes[..., 1] = torque / cam.shaft.stiffness
    return WindupState(np.concatenate((nodes[-1:, -1], nodes[:, -1])), nodes)


def _too_soft(cam: CamOnShaft) -> EffectError:
    hertz = cam.shaft.natural_frequency / TURN
    return EffectError(
        "no steady state was found in which the cam always turns forward: the camshaft is too"
        " soft for the torque of the cam, or swings in resonance with it. The cam alone swings on"
        f" it at {hertz:.6g} Hz, and its drive turns at {cam.speed / RPM:.6g} rev/min",
        finding="soft-shaft",
        value=hertz,
        unit="Hz",
    )


# -- cam on its shaft -----------------------------------------------------------------------------
# A cam at the end of an elastic shaft: its equations of motion over the cam angle.
#
# Its drive turns at constant speed Omega. The wind-up w is the angle by which the cam lags behind
# the drive, the speed of the cam is omega. The shaft carries k w + c (Omega - omega), so that over
# the cam angle, with y = omega^2 / 2,
#
#     dy/dphi = alpha = (k w + c (Omega - omega) - T) / J,        dw/dphi = Omega / omega - 1,
#
# with the torque T of the cam solved for alpha as in `camgeo.dynamics.effects.shaft`. The unknowns
# are v, with y = Omega^2 (1/2 + v), and w: of a stiff shaft both are small, and keep their
# precision, as
#
#     Omega / omega - 1 = -2 v / (r (1 + r)),        r = omega / Omega = sqrt(1 + 2 v).


@dataclass(frozen=True, slots=True, eq=False)
class Twist:
    """The torque of the shaft on the cam over its speed, at given windups.

    Attributes
    ----------
    stiffness, viscosity : k [N mm/rad] and c [N mm s].
    speed : Omega [rad/s].
    windup : (...) w [rad].
    """

    stiffness: float
    viscosity: float
    speed: float
    windup: FloatArray

    def torque(self, omega: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque [N mm] and its derivative [N mm s] at the speeds `omega` (...) [rad/s]."""
        carried = self.stiffness * self.windup + self.viscosity * (self.speed - omega)
        return carried, np.full(carried.shape, -self.viscosity)


@dataclass(frozen=True, slots=True, eq=False)
class CamOnShaft:
    """The cam at the end of the shaft.

    Attributes
    ----------
    shaft : the elastic shaft.
    speed : Omega [rad/s] of its drive.
    """

    shaft: ElasticShaft
    speed: float

    def driven(self, windup: FloatArray) -> Shaft[Twist]:
        """The cam with the shaft wound up by `windup` (...) [rad]."""
        shaft = self.shaft
        twist = Twist(shaft.stiffness, shaft.viscosity, self.speed, windup)
        return Shaft(shaft.moment_of_inertia, twist)

    def stiffened(self, factor: float) -> CamOnShaft:
        """The same cam on a shaft stiffer by the `factor`."""
        stiffness = factor * self.shaft.stiffness
        return CamOnShaft(replace(self.shaft, stiffness=stiffness), self.speed)

    def y(self, v: FloatArray) -> FloatArray:
        """(...) omega^2 / 2 [rad^2/s^2]."""
        return np.asarray(self.speed**2 * (0.5 + v))

    def rates(self, laws: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(..., 2) derivatives of v and w by the cam angle, and theirs (..., 2, 2) by v and w.

        Parameters
        ----------
        laws : (6 or more, ...) the torque law.
        state : (..., 2) v and w.
        """
        v, w = state[..., 0], state[..., 1]
        alpha, growth, per_torque = self.driven(w).response(laws, self.y(v))
        r = np.sqrt(1.0 + 2.0 * v)
        derivatives = np.stack((alpha / self.speed**2, -2.0 * v / (r * (1.0 + r))), axis=-1)
        slopes = np.zeros((*v.shape, 2, 2))
        slopes[..., 0, 0] = growth
        slopes[..., 0, 1] = self.shaft.stiffness / self.speed**2 * per_torque
        slopes[..., 1, 0] = -1.0 / r**3
        return derivatives, slopes


# -- periodic -------------------------------------------------------------------------------------
# The periodic motion of a cam at the end of an elastic shaft, by collocation over the whole turn.
#
# The equations are in `camgeo.dynamics.effects.camshaft_windup`, the cell is that of
# `camgeo.dynamics.effects.shaft`, and the error estimate is the change by one more Newton step on
# the mesh of all halves of the cells.


MOST_STEPS: Final = 40
"""Largest number of Newton steps."""

FULL_STEPS: Final = 15
"""Number of full Newton steps; later ones are halved, as a kink may make them alternate."""

MOST_PASSES: Final = 60
"""Largest number of mesh refinements."""

MOST_CELLS: Final = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class WindupState:
    """v and w in the cells of a mesh.

    Attributes
    ----------
    starts : (m + 1, 2) at the ends of the cells.
    nodes : (m, n, 2) at their nodes.
    """

    starts: FloatArray
    nodes: FloatArray

    @property
    def all_nodes(self) -> FloatArray:
        """(m, n + 1, 2) at the start and at the nodes of each cell."""
        return np.concatenate((self.starts[:-1, np.newaxis], self.nodes), axis=1)

    @property
    def largest_windup(self) -> float:
        """Largest magnitude of the wind-up at the nodes [rad]; 1, a divisor, where that is 0."""
        return float(np.max(np.abs(self.nodes[..., 1]))) or 1.0


@dataclass(frozen=True, slots=True, eq=False)
class NewtonStep:
    """A Newton step: the changes, the defect (m, 2) of each cell, and the monodromy matrix."""

    starts: FloatArray
    nodes: FloatArray
    defects: FloatArray
    monodromy: FloatArray


def newton_step(cam: CamOnShaft, mesh: Mesh, pair: WindupState) -> NewtonStep:
    """The Newton step from `pair`, on all cells of the turn together."""
    rates, slopes = cam.rates(mesh.laws, pair.nodes)
    # (m, n, n) from the rates at the nodes to the changes since the start of each cell.
    inner = mesh.spans[:, np.newaxis, np.newaxis] * collocation().integral
    residual = pair.starts[:-1, np.newaxis] + inner @ rates - pair.nodes
    # The rate of w depends on v alone, so that dw is dv's consequence: the equations are solved for
    # dv, from 1 at the start in v and in w, and from the residual.
    by_v, by_w = (inner * slopes[:, np.newaxis, :, 0, column] for column in (0, 1))
    w_by_v = inner * slopes[:, np.newaxis, :, 1, 0]
    matrix = np.eye(NODES) - by_v - by_w @ w_by_v
    # Columns 0 and 1 are the responses to a unit change of v and w at the start of the cell, column
    # 2 is that to the residual.
    solved = np.zeros((*residual.shape, 3))
    solved[:, :, 0, 0] = solved[:, :, 1, 1] = 1.0
    solved[..., 2] = residual
    solved[:, :, 0] = np.linalg.solve(matrix, solved[:, :, 0] + by_w @ solved[:, :, 1])
    solved[:, :, 1] += w_by_v @ solved[:, :, 0]
    # Radau's last node is the end of the cell.
    factors, responses = solved[:, -1, :, :2], solved[:, -1, :, 2]
    offsets = responses + pair.nodes[:, -1] - pair.starts[1:]
    products, shifts = _cumulative_maps(factors, offsets)
    # Periodicity: the state at the end of the turn is that at its start.
    try:
        closing = shifts[-1] + pair.starts[-1] - pair.starts[0]
        first = np.linalg.solve(np.eye(2) - products[-1], closing)
    except np.linalg.LinAlgError as error:
        raise NoConvergenceError(None) from error
    starts = products @ first + shifts
    # At the nodes n of cell m: the response to the change at the start of the cell, and to its
    # residual.
    nodes = np.einsum("mnij,mj->mni", solved[..., :2], starts[:-1]) + solved[..., 2]
    return NewtonStep(starts, nodes, np.max(np.abs(solved[..., 2]), axis=1), products[-1])


def _cumulative_maps(factors: FloatArray, offsets: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(m + 1, 2, 2) A and (m + 1, 2) b: a change x at the start of the turn becomes A x + b at the
    start of each cell and at the end of the turn, where a single cell maps x to `factors` (m, 2, 2)
    x + `offsets` (m, 2).
    """
    # A x + b as a matrix of 3 rows, so that one after the other is a matrix product.
    maps = np.zeros((len(factors) + 1, 3, 3))
    maps[:] = np.eye(3)
    maps[1:, :2, :2], maps[1:, :2, 2] = factors, offsets
    # Doubling needs log2(m) products of whole arrays instead of m single ones.
    together = 1
    while together < len(maps):
        maps[together:] = maps[together:] @ maps[:-together]
        together *= 2
    return maps[:, :2, :2], maps[:, :2, 2]


@dataclass(frozen=True, eq=False)
class WindupTurn:
    """A turn of the steady state, with its error estimates.

    Attributes
    ----------
    cam : the cam on its shaft.
    mesh : the cells.
    pair : v and w in them.
    rates : (m, n) alpha at the nodes [rad/s^2].
    multiplier : the share of a disturbance that is left after a turn, at most: the size of the
        larger eigenvalue of the monodromy matrix.
    multiplier_error : estimate of its error.
    speed_error : estimate of the largest error of the speed [rad/s].
    windup_error : that of the wind-up [rad].
    rough : the steady state on cells twice as long, from which the errors are estimated; None for
        it.
    """

    cam: CamOnShaft
    mesh: Mesh
    pair: WindupState
    rates: FloatArray
    multiplier: float
    multiplier_error: float
    speed_error: float
    windup_error: float
    rough: WindupTurn | None

    @property
    def state(self) -> State:
        """y in the cells."""
        square = self.cam.speed**2
        v = (self.pair.starts[:, 0], self.pair.nodes[..., 0])
        return State(0.5 * square, *(square * values for values in v))

    @cached_property
    def _series(self) -> FloatArray:
        """(m, n + 1, 2) Legendre coefficients of v and w in each cell."""
        return np.asarray(collocation().fit @ self.pair.all_nodes)

    def evaluate(self, phi: FloatArray) -> FloatArray:
        """(n, 2) v and w at `phi` (n,) [rad], in any turn."""
        cell, x = self.mesh.placed(phi)
        return np.asarray(np.einsum("ni,nik->nk", legendre(x, NODES), self._series[cell]))

    def resample(self, mesh: Mesh) -> WindupState:
        """v and w in the cells of another `mesh`."""
        shape = mesh.nodes.shape
        nodes = self.evaluate(mesh.nodes.ravel()).reshape(*shape, 2)
        return WindupState(np.concatenate((self.evaluate(mesh.low[:1]), nodes[:, -1])), nodes)

    def windup(self, phi: FloatArray) -> FloatArray:
        """(n,) w [rad]."""
        return self.evaluate(phi)[:, 1]

    def omega(self, phi: FloatArray) -> FloatArray:
        """(n,) speed [rad/s]."""
        return np.sqrt(2.0 * self.cam.y(self.evaluate(phi)[:, 0]))

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `camgeo.dynamics.effects.shaft.SteadyTurn`: of omega and w, whose rates are alpha /
        omega and Omega / omega - 1.
        """
        shaft, y = self.driven(phi)
        omega = np.sqrt(2.0 * y)
        alpha, growth, per_torque = shaft.response(rows, y)
        slopes, differences = np.zeros((len(phi), 2, 2)), np.zeros((len(phi), 2))
        # d(alpha / omega) / domega, where growth is dalpha/dy and dy = omega domega.
        slopes[:, 0, 0] = growth - alpha / omega**2
        slopes[:, 0, 1] = self.cam.shaft.stiffness * per_torque / omega
        slopes[:, 1, 0] = -self.cam.speed / omega**2
        differences[:, 0] = (shaft.rate(other, y)[0] - alpha) / omega
        return slopes, differences

    def driven(self, phi: FloatArray) -> tuple[Shaft[Twist], FloatArray]:
        """The cam with its shaft wound up as at `phi` (n,) [rad], and y (n,) there."""
        v, w = self.evaluate(phi).T
        return self.cam.driven(w), self.cam.y(v)


def periodic(
    cam: CamOnShaft, law: Quantity, mesh: DoubleMesh, pair: WindupState, tolerance: float
) -> WindupTurn:
    """The periodic solution near `pair`.

    Parameters
    ----------
    cam : the cam on its shaft.
    law : the torque law of the cam.
    mesh : initial mesh; no cell contains an edge of the law.
    pair : initial guess on the coarse mesh.
    tolerance : largest error of speed and wind-up, relative to the largest of each.

    Raises
    ------
    NoConvergenceError
        If no solution is found.
    StuckError
        If friction leaves no acceleration.
    """
    reached = math.inf
    for _ in range(MOST_PASSES):
        pair, left = newton(cam, mesh.coarse, pair, tolerance)
        fine = _interpolate_halves(pair)
        step = newton_step(cam, mesh.fine, fine)
        scales = np.array([1.0, pair.largest_windup])
        errors = np.max(_relative(step.nodes, fine), axis=(0, 1)) * scales
        errors = INTERIOR_FACTOR * errors + left * scales + _rounding(cam, step.monodromy, fine)
        reached = float(np.max(errors / scales))
        if reached <= tolerance:
            exact, last = newton(cam, mesh.fine, fine, tolerance)
            errors = errors + last * scales
            estimates = (
                *_multiplier(cam, mesh, pair, exact),
                cam.speed * float(errors[0]),
                float(errors[1]),
            )
            rough = WindupTurn(
                cam, mesh.coarse, pair, _alpha(cam, mesh.coarse, pair), *estimates, None
            )
            return WindupTurn(
                cam, mesh.fine, exact, _alpha(cam, mesh.fine, exact), *estimates, rough
            )
        # A coarse cell has two halves with two unknowns each.
        worst = np.max((step.defects / scales).reshape(-1, 4), axis=1)
        # Halving the worst cells alone keeps the mesh small where the solution is smooth.
        split = worst >= 0.1 * np.max(worst)
        cells = len(split) + int(np.count_nonzero(split))
        if not np.max(worst) > EPS * EPS or cells > MOST_CELLS:
            break
        mesh = mesh.refined(law, split)
        both = np.repeat(split, 2)
        nodes = interleaved(split, pair.nodes, fine.nodes[both])
        starts = interleaved(split, pair.starts[:-1], fine.starts[:-1][both])
        pair = WindupState(np.concatenate((starts, pair.starts[-1:])), nodes)
    raise NoConvergenceError(reached)


def newton(
    cam: CamOnShaft, mesh: Mesh, pair: WindupState, tolerance: float
) -> tuple[WindupState, float]:
    """The collocation solution, and its last change as a share; raises as `periodic`."""
    target = max(1e-3 * tolerance, 16.0 * EPS)
    best = math.inf
    for count in range(MOST_STEPS):
        if not min(np.min(pair.nodes[..., 0]), np.min(pair.starts[:, 0])) > -0.5:
            raise NoConvergenceError(None)  # the speed has become 0, step by step
        step = newton_step(cam, mesh, pair)
        down = float(np.max(-step.nodes[..., 0] / (0.5 + pair.nodes[..., 0])))
        ends = float(np.max(-step.starts[:, 0] / (0.5 + pair.starts[:, 0])))
        # A step must leave the share KEEP of y = Omega^2 (1/2 + v), which is above 0.
        share = min(1.0, (1.0 - KEEP) / max(down, ends, 1e-300))
        if count >= FULL_STEPS:
            share *= 0.5
        change = float(np.max(_relative(step.nodes, pair)))
        pair = WindupState(pair.starts + share * step.starts, pair.nodes + share * step.nodes)
        if not math.isfinite(change):
            raise NoConvergenceError(None)
        # Near the solution a change that no longer falls is rounding.
        stalled = change >= 0.25 * best and best <= max(0.1 * tolerance, 1e4 * EPS)
        if share == 1.0 and (change <= target or stalled):
            # The error after a Newton step is about the square of its change, unless that is
            # rounding.
            return pair, change if stalled and change > target else change * change
        best = min(best, change)
    raise NoConvergenceError(None)


def _relative(changes: FloatArray, pair: WindupState) -> FloatArray:
    """(m, n, 2) `changes` of speed and windup, relative to the drive's speed and the largest
    windup.
    """
    r = np.sqrt(1.0 + 2.0 * np.maximum(pair.nodes[..., 0], -0.5 + 0.5 * KEEP))
    sizes = np.stack((1.0 / r, np.full(r.shape, 1.0 / pair.largest_windup)), axis=-1)
    return np.asarray(np.abs(changes) * sizes)


def _multiplier(
    cam: CamOnShaft, mesh: DoubleMesh, rough: WindupState, pair: WindupState
) -> tuple[float, float]:
    """The size of the larger eigenvalue of the monodromy matrix, and an estimate of its error: the
    change from the coarse mesh, and rounding, which is more where the two are nearly equal.
    """
    steps = (newton_step(cam, *solution) for solution in ((mesh.coarse, rough), (mesh.fine, pair)))
    ends = [np.linalg.eigvals(step.monodromy) for step in steps]
    coarse, fine = (float(np.max(np.abs(eigenvalues))) for eigenvalues in ends)
    rounding = ROUNDINGS * EPS * len(mesh.fine.low)
    gap = float(np.abs(ends[1][0] - ends[1][1])) / max(fine, 1e-300)
    # A double eigenvalue moves by the root of a change of the matrix.
    rounding *= 1.0 + 1.0 / max(gap, math.sqrt(rounding))
    return fine, INTERIOR_FACTOR * abs(fine - coarse) + rounding * max(fine, EPS)


def _rounding(cam: CamOnShaft, monodromy: FloatArray, pair: WindupState) -> FloatArray:
    """(2,) what rounding of the torque does to v and w.

    A torque off by e winds the shaft up by e / k, and sways the speed by that times the natural
    frequency; of a disturbance, 1 / (1 - multiplier) is what it adds up to over all turns.
    """
    shaft = cam.shaft
    windup = pair.largest_windup + shaft.viscosity * cam.speed / shaft.stiffness
    distance = max(float(np.min(np.abs(1.0 - np.linalg.eigvals(monodromy)))), EPS)
    ratio = shaft.natural_frequency / cam.speed
    return np.asarray(ROUNDINGS * EPS * windup * (1.0 + 1.0 / distance) * np.array([ratio, 1.0]))


def _alpha(cam: CamOnShaft, mesh: Mesh, pair: WindupState) -> FloatArray:
    """(m, n) alpha at the nodes [rad/s^2]."""
    return np.asarray(cam.speed**2 * cam.rates(mesh.laws, pair.nodes)[0][..., 0])


def _interpolate_halves(pair: WindupState) -> WindupState:
    """The polynomials through the nodes of all cells, at the nodes of their halves; v is kept where
    there is a speed.
    """
    # Values at the nodes i of both halves h of cell m, for v and w alike (k).
    halves = np.einsum("hij,mjk->mhik", collocation().halves, pair.all_nodes)
    halves[..., 0] = np.maximum(halves[..., 0], -0.5 + 0.5 * KEEP)
    middles = halves[:, 0, -1]
    starts = np.stack((pair.starts[:-1], middles), axis=1).reshape(-1, 2)
    return WindupState(np.concatenate((starts, pair.starts[-1:])), halves.reshape(-1, NODES, 2))
