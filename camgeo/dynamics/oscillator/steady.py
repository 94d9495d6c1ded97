"""Response of an elastic train to a periodic motion of its base, and to a periodic force on its
output: the exact steady state.

`Forcing` drives the modes and follows from the motion of the base, or is the force.

Over the turn each mode is multiplied by exp(lambda T) and gains g from the forcing, so it is
periodic if it begins with g / (1 - exp(lambda T)).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.dynamics.oscillator.train import EPS, Reading, Train
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    frozen,
    grouped,
)

FINEST: Final = 1e-14
"""Smallest fraction of the forcing that its series may truncate: rounding of the forcing itself."""

SOFT: Final = 1.0
"""|lambda| T below which the lift is the forcing, not the acceleration. The deflection of a train
that is slow compared with the turn is nearly -y, and integrating the acceleration twice over the
turn would magnify its rounding by 1 / |lambda T|^2."""

ROUNDINGS: Final = 8.0
"""Number of roundings that the estimates assume for each step."""


@dataclass(frozen=True, slots=True, eq=False)
class Base:
    """The periodic motion of the base.

    Attributes
    ----------
    jet : t (n,), side -> (3 or more, n) y, y', y'' over time; y repeats itself with the period.
    edges : (m + 1,) times from 0 to the period between which y is smooth; y is continuous at them,
        y' and y'' may jump.
    """

    jet: Callable[[FloatArray, Side], FloatArray]
    edges: FloatArray

    @property
    def period(self) -> float:
        return float(self.edges[-1])

    def jumps(self) -> FloatArray:
        """(m,) jump of y' at each edge but the last, which is the first one of the next turn."""
        right = self.jet(self.edges[:-1], "right")[1]
        left = np.roll(self.jet(self.edges[1:], "left")[1], 1)
        return np.asarray(right - left)


@dataclass(frozen=True, slots=True, eq=False)
class Forcing:
    """The forcing of the modes: -y'' with the jumps of -y', or y itself, or the force p.

    Attributes
    ----------
    pieces : the forcing as series.
    jumps : (p,) jump of u at the start of each piece.
    soft : whether the forcing is y.
    """

    pieces: PiecewiseSeries
    jumps: FloatArray
    soft: bool

    def gain(self, rate: complex, period: float) -> complex:
        """The value at the end of the turn of a mode that is 0 before the first jump."""
        count = self.pieces.series.shape[1]
        cells = solve(self.pieces, np.arange(count), np.full(count, rate))
        return total_gain(cells, self.jumps, period)

    def times(self, factor: float) -> Forcing:
        """`factor` times the forcing."""
        return Forcing(self.pieces.times(factor), factor * self.jumps, self.soft)

    def noise(self, period: float, frequency: float = 0.0) -> float:
        """Estimate of the error of the integral of forcing and exp(i `frequency` t)."""
        size = self.pieces.largest * period + float(np.sum(np.abs(self.jumps)))
        return self.pieces.error + ROUNDINGS * EPS * (1.0 + frequency * period) * size


def base_forcing(train: Train, base: Base, tolerance: float) -> Forcing:
    """The forcing of the modes of `train` by `base`."""
    soft = float(np.min(np.abs(train.rates))) * base.period < SOFT
    order, sign = (0, 1.0) if soft else (2, -1.0)
    pieces = interpolated(
        lambda t: sign * base.jet(t, "right")[order],
        base.edges,
        max(tolerance, FINEST),
        ROUNDINGS * EPS * base.period,
    )
    jumps = np.zeros(pieces.series.shape[1])
    if not soft:
        # Interpolation may have halved pieces: the jumps belong to those that begin at an edge.
        jumps[np.searchsorted(pieces.edges, base.edges[:-1])] = -base.jumps()
    return Forcing(pieces, jumps, soft)


def load_forcing(
    force: Callable[[FloatArray], FloatArray], edges: FloatArray, share: float
) -> Forcing:
    """The forcing by a `force` (n,) at `t` (n,) that is smooth between `edges` (m + 1,).

    Its series may truncate the `share` of its magnitude.
    """
    rounding = ROUNDINGS * EPS * float(edges[-1])
    pieces = interpolated(force, edges, max(share, FINEST), rounding)
    return Forcing(pieces, np.zeros(pieces.series.shape[1]), soft=False)


CIRCLE: Final = 20
"""Points of the mean over a circle of radius 1 / T in lambda; the mean of an analytic function with
its nearest pole 2 pi / T away errs by (2 pi)^-20."""


class ResonanceError(ArithmeticError):
    """There is no steady state: an undamped mode grows with every turn.

    Attributes
    ----------
    frequency : of the mode [rad/s].
    harmonic : of the turn with which it coincides.
    """

    def __init__(self, frequency: float, harmonic: int) -> None:
        self.frequency = frequency
        self.harmonic = harmonic
        super().__init__(f"an undamped mode coincides with harmonic {harmonic}")


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """The response of a train to its base and to a force on its output.

    Attributes
    ----------
    train, base, forcing : the system and its excitation.
    modes : over the turn; of u' = lambda u + forcing.
    errors : (m,) estimates of the largest error of each mode, driven by -y''.
    load : the force p on the output, None without one.
    loaded, loaded_errors : the same of v' = lambda v + p; empty without a load.
    """

    train: Train
    base: Base
    forcing: Forcing
    modes: tuple[Mode, ...]
    errors: FloatArray
    load: Forcing | None = None
    loaded: tuple[Mode, ...] = ()
    loaded_errors: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def error(self) -> float:
        """Estimate of the largest error of the output's deflection, in the unit of y."""
        return self.reading_error(self.train.deflection(self.train.output))

    def reading_error(self, reading: Reading) -> float:
        """Estimate of the largest error of `reading`, with the rounding of its weights."""
        error = float(np.sum(np.abs(reading.weights) * self.errors))
        if self.load is not None:
            error += float(np.sum(np.abs(reading.loaded) * self.loaded_errors))
        return error

    def states(self, t: FloatArray, side: Side) -> FloatArray:
        """(3, n) deflection e, its velocity e', and the acceleration x'' of the output.

        `t` (n,) in [0, period]. Only a jump of the base's velocity, which the damper feels, makes
        e' jump, and that or a jump of the load x''.
        """
        return self.mass_states(self.train.output, t, side)

    def mass_states(self, mass: int, t: FloatArray, side: Side) -> FloatArray:
        """`states` of the `mass`, counted from 0 at the base."""
        train = self.train
        readings = train.deflection(mass), train.velocity(mass), train.acceleration(mass)
        return self.read(readings, t, side)

    def forces(self, links: Sequence[int], t: FloatArray, side: Side) -> FloatArray:
        """(k, n) forces in the `links`, see `Train.force`."""
        return self.read([self.train.force(link) for link in links], t, side)

    def read(self, readings: Sequence[Reading], t: FloatArray, side: Side) -> FloatArray:
        """(k, n) the `readings` at `t` (n,)."""
        t = self._wrap_time(t, side)
        rates = self.train.rates
        weights = np.stack([reading.weights for reading in readings])
        slow = np.array([(reading.lift, reading.slope) for reading in readings])
        if self.forcing.soft:
            # u = -(y' + lambda y + lambda^2 p) with p' = lambda p + y
            slow -= np.stack(
                (np.sum(weights * rates, axis=1), np.sum(weights, axis=1)), axis=1
            ).real
            weights = -weights * rates**2
        values = _summed(self.modes, weights, t, side)
        if np.any(slow):
            values += slow @ self.base.jet(t, side)[:2]
        if self.load is not None:
            loaded = np.stack([reading.loaded + 0.0 * self.train.rates for reading in readings])
            values += _summed(self.loaded, loaded, t, side)
            direct = np.array([reading.direct for reading in readings])
            if np.any(direct):
                # An acceleration follows the load at once.
                values += np.multiply.outer(direct, self.load.pieces.values(t, side))
        return values

    def at_rest(self, reading: Reading, t: FloatArray, side: Side) -> FloatArray:
        """(n,) share of a `reading` that a load has which stays as it is at `t` (n,)."""
        if self.load is None:
            return np.zeros(len(t))
        held = self.load.pieces.values(self._wrap_time(t, side), side)
        return np.asarray(self.train.yielding(reading) * held)

    def free_amplitude(self, t: FloatArray, side: Side) -> FloatArray:
        """(n,) amplitude of the free vibration of the output while the base rests, and the load
        stays as it is.

        For one mass |u| / (w sqrt(1 - D^2)) = sqrt(e^2 + (e' + D w e)^2 / (w^2 (1 - D^2))), the
        amplitude that then decays with exp(-D w t); for more masses the sum of all modes, which
        they reach together sooner or later. Modes that nearly coincide, around mu, are
        (a + b t) exp(mu t) together, and count as |a| + |b / Re mu|, which is not exceeded.
        """
        t = self._wrap_time(t, side)
        train = self.train
        y = self.base.jet(t, side)[:2] if self.forcing.soft else None
        held = None if self.load is None else self.load.pieces.values(t, side)
        at_once = np.zeros((2, len(train.centre), len(t)), dtype=np.complex128)
        weights, loaded = train.shapes[train.output], train.loaded[train.output]
        for i, (mode, c, rate, group) in enumerate(
            zip(self.modes, weights, train.rates, train.group.tolist(), strict=True)
        ):
            u = mode.values(t, side)
            if y is not None:
                u = -(rate**2) * u - y[1] - rate * y[0]
            u *= c
            if held is not None:
                u += loaded[i] * (self.loaded[i].values(t, side) + held / rate)
            at_once[0, group] += u
            at_once[1, group] += (rate - train.centre[group]) * u
        real = train.centre.imag == 0.0
        # Around a real centre the modes are real together.
        at_once[:, real] = at_once[:, real].real
        amplitude, growth = np.abs(at_once)
        with np.errstate(divide="ignore", invalid="ignore"):
            later = growth / np.abs(train.centre.real)[:, np.newaxis]
        return np.asarray(np.sum(amplitude + np.where(growth > 0.0, later, 0.0), axis=0))

    def harmonic(self, number: int) -> complex:
        """Coefficient of exp(i number 2 pi t / T) in the deflection, less that of the load at rest,
        for number >= 1.

        Base or load that contain this harmonic only as rounding have no part in it.
        """
        period = self.base.period
        frequency = number * 2.0 * math.pi / period

        def content(forcing: Forcing) -> complex:
            gain = forcing.gain(1j * frequency, period)
            return 0.0j if abs(gain) <= forcing.noise(period, frequency) else gain / period

        # A harmonic of y is that of -y'' divided by the square of its frequency.
        base_content = content(self.forcing) * (frequency**2 if self.forcing.soft else 1.0)
        moved = self.train.transfer(frequency) * base_content
        if self.load is not None:
            moved += self.train.compliance(frequency) * content(self.load)
        return moved

    def in_time(self, factor: float) -> Response:
        """The response of the train in a time that passes `factor` times as fast, see
        `Train.in_time`.
        """
        load = None if self.load is None else self.load.times(factor**-2)
        return periodic_response(self.train.in_time(factor), self.base, self.forcing, load)

    @property
    def fastest(self) -> float:
        """The factor up to which that has the same kind of forcing, see `SOFT`."""
        return float(np.min(np.abs(self.train.rates))) * self.base.period / SOFT

    def _wrap_time(self, t: FloatArray, side: Side) -> FloatArray:
        period = self.base.period
        if side == "left":
            # From the left, the start is the end of the period before.
            return np.where(t <= 0.0, period, t)
        return np.where(t >= period, 0.0, t)


def _summed(modes: Sequence[Mode], weights: ComplexArray, t: FloatArray, side: Side) -> FloatArray:
    """(k, n) Re sum w u at `t` (n,), with the `weights` (k, m) of the modes."""
    sums = np.zeros((len(weights), len(t)))
    for mode, weight in zip(modes, weights.T, strict=True):
        u = mode.values(t, side)
        sums += np.multiply.outer(weight.real, u.real) - np.multiply.outer(weight.imag, u.imag)
    return sums


def steady_state(
    train: Train, base: Base, tolerance: float, load: Forcing | None = None
) -> Response:
    """The periodic response to the base, and to a force on the output.

    Parameters
    ----------
    tolerance : fraction of the magnitude of the forcing that its series may truncate, on average.
    load : see `load_forcing`, over the period of the base.

    Raises
    ------
    ResonanceError
        See `periodic_response`.
    """
    return periodic_response(train, base, base_forcing(train, base, tolerance), load)


def periodic_response(
    train: Train, base: Base, forcing: Forcing, load: Forcing | None = None
) -> Response:
    """The periodic response to the `forcing` of `base`, which is soft as it is for `train`, and to
    the `load`.

    Raises
    ------
    ResonanceError
        If an undamped mode coincides with a harmonic that base or load contain. If they do not
        contain it, the growing part is omitted: the mode is the limit for neighbouring frequencies.
    """
    base_modes = _periodic_modes(train, forcing, base.period)
    if load is None:
        return Response(train, base, forcing, *base_modes)
    return Response(
        train, base, forcing, *base_modes, load, *_periodic_modes(train, load, base.period)
    )


def _periodic_modes(
    train: Train, forcing: Forcing, period: float
) -> tuple[tuple[Mode, ...], FloatArray]:
    """The modes with their errors; raises as `periodic_response`."""
    count = forcing.pieces.series.shape[1]
    modes, errors = [], []
    noise = forcing.noise(period)
    for rate, drift, doubt in zip(
        train.rates.tolist(), train.drift.tolist(), train.doubt.tolist(), strict=True
    ):
        cells = solve(forcing.pieces, np.arange(count), np.full(count, rate))
        # What rounding of lambda makes of the phase lambda T: a smaller loss is 0.
        phase = ROUNDINGS * EPS * abs(rate) * period * drift
        gain = total_gain(cells, forcing.jumps, period)
        loss = abs(_loss(rate, period))
        if loss <= phase:
            if abs(gain) > forcing.noise(period, abs(rate) * drift):
                raise ResonanceError(abs(rate), round(abs(rate) * period / (2.0 * math.pi)))
            begin = _resonant_start(forcing, rate, period)
            loss = 1.0
        else:
            begin = gain / _loss(rate, period)
        mode = follow_mode(cells, forcing.jumps, period, begin)
        # An error made in a turn comes back after it, and adds up to 1 / |1 - exp(lambda T)| in
        # all.
        error = (noise + phase * mode.largest) * (1.0 + 1.0 / loss)
        error += ROUNDINGS * EPS * doubt * mode.largest
        errors.append(error * (abs(rate) ** 2 if forcing.soft else 1.0))
        modes.append(mode)
    return tuple(modes), np.array(errors)


def _loss(rate: complex, period: float) -> complex:
    """1 - exp(lambda T)."""
    return -complex(np.expm1(rate * period))


def _resonant_start(forcing: Forcing, rate: complex, period: float) -> complex:
    """Limit of the initial value of a mode whose gain and loss vanish: Cauchy's mean value."""
    around = [
        rate + cmath.rect(1.0 / period, 2.0 * math.pi * (k + 0.5) / CIRCLE) for k in range(CIRCLE)
    ]
    return sum(forcing.gain(point, period) / _loss(point, period) for point in around) / CIRCLE


# -- mode -----------------------------------------------------------------------------------------
# Series of the forcing, and the closed-form solution of the modal equation u' = lambda u + a(t)
# with them.
#
# On a cell of half length H, with x from -1 to 1 and kappa = lambda H, the solution is a polynomial
# and a free vibration,
#
#     u = Q(x) + C exp(kappa (x + 1)),   dQ/dx = kappa Q + H a.
#
# Integrated term by term this gives, for the coefficients q_k of Q and a_k of a and k >= 1,
#
#     2 k q_k = kappa (c q_{k-1} - q_{k+1}) + H (c a_{k-1} - a_{k+1}),   c = 2 for k = 1, else 1
#
# (C. W. Clenshaw, Proc. Camb. Phil. Soc. 53 (1957) 134-149). Where |kappa| is large, Q is the
# polynomial of the degree of a that these rows give from the highest downwards; no row then
# magnifies the rounding of the one above. Where |kappa| is small they are a recurrence whose
# desired solution decreases with k, so it is eliminated backwards (F. W. J. Olver, J. Res. Nat.
# Bur. Standards 71B (1967) 111-129). In between, the piece is cut until |kappa| is small.


DEGREE: Final = 16
"""Degree of the series on a piece. Half a period of a sine needs this much for 16 digits, a
polynomial law less; a piece that needs more is halved."""

MOST_HALVINGS: Final = 40
"""A piece is halved at most this often. Repeated halving closes in on a kink that is not an edge;
its piece is then 1e-12 of the original."""

MOST_PIECES: Final = 4000
"""Pieces, or four times as many as there were, beyond which none is halved any further: what is
rounding and nothing else is as rough on any piece."""

_ANGLES: Final = np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)

NODES: Final = frozen(-np.cos(_ANGLES), np.float64)
"""(17,) zeros of T_17, ascending: inside the piece, where the function has a single value."""

TO_SERIES: Final = frozen(
    np.cos(np.outer(np.arange(DEGREE + 1), np.pi - _ANGLES))
    * np.where(np.arange(DEGREE + 1) == 0, 1.0, 2.0)[:, np.newaxis]
    / (DEGREE + 1),
    np.float64,
)
"""(17, 17) from the values at the nodes to the coefficients, by the discrete orthogonality of the
polynomials (Trefethen, Approximation Theory and Approximation Practice, chapter 3)."""

ORDERS: Final = frozen(np.arange(DEGREE + 1), np.float64)

TAIL: Final = 3
"""Number of last coefficients whose sum estimates the truncation."""


@dataclass(frozen=True, slots=True, eq=False)
class PiecewiseSeries:
    """A function as Chebyshev series.

    Attributes
    ----------
    edges : (p + 1,) ascending; the pieces lie between neighbours.
    series : (17, p) coefficients of T_0 to T_16 on each piece.
    error : estimate of the integral of the magnitude of the truncated terms.
    largest : magnitude of the function at the nodes.
    """

    edges: FloatArray
    series: FloatArray
    error: float
    largest: float

    def times(self, factor: float) -> PiecewiseSeries:
        """`factor` times the function."""
        size = abs(factor)
        return PiecewiseSeries(
            self.edges, factor * self.series, size * self.error, size * self.largest
        )

    @property
    def steepest(self) -> float:
        """A bound of the magnitude of its slope on any piece (Markov: |T_k'| is at most k^2)."""
        half = 0.5 * np.diff(self.edges)
        return float(np.max(ORDERS**2 @ np.abs(self.series) / half))

    @property
    def jumps(self) -> FloatArray:
        """(p,) its jump at the start of each piece; the last one ends where the first begins."""
        ends = np.sum(self.series, axis=0)
        starts = 2.0 * np.sum(self.series[::2], axis=0) - ends
        return np.asarray(starts - np.roll(ends, 1))

    def values(self, t: FloatArray, side: Side) -> FloatArray:
        """(n,) the function at `t` (n,) between the edges."""
        place = np.clip(np.searchsorted(self.edges, t, side) - 1, 0, self.series.shape[1] - 1)
        low, high = self.edges[place], self.edges[place + 1]
        return self.evaluate(place, (2.0 * t - low - high) / (high - low))

    def evaluate(self, piece: IntArray, x: FloatArray) -> FloatArray:
        """The function at `x`, from -1 to 1 over each `piece`; both broadcast."""
        return series_values(self.series[:, piece], x)


def interpolated(
    function: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    tolerance: float,
    rounding: float = 0.0,
) -> PiecewiseSeries:
    """`function` as series.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges; it is not evaluated at them.
    edges : (m + 1,) ascending, m >= 1.
    tolerance : a piece is halved until the estimated integral of its truncation is below this
        fraction of the integral of the function's magnitude.
    rounding : of the argument; what it changes, halving does not reduce, and it stays part of the
        error.
    """
    low, high = edges[:-1], edges[1:]
    starts, rows = [], []
    size, largest, error = 0.0, 0.0, 0.0
    most = max(MOST_PIECES, 4 * len(low))
    for halving in range(MOST_HALVINGS + 1):
        half = 0.5 * (high - low)
        x = (0.5 * (high + low))[:, np.newaxis] + half[:, np.newaxis] * NODES
        values = function(x.ravel()).reshape(x.shape)
        magnitude = np.max(np.abs(values), axis=1)
        largest = max(largest, float(np.max(magnitude)))
        if halving == 0:
            # The scale of the tolerance is that of the whole function, not of what is halved.
            size = float(np.sum(2.0 * half * magnitude))
        series = values @ TO_SERIES.T
        # The last coefficients estimate those that are left out.
        lost = 2.0 * half * np.sum(np.abs(series[:, -TAIL:]), axis=1)
        steepest = np.abs(series) @ ORDERS**2 / half  # see `Pieces.steepest`
        good = (lost <= tolerance * size) | (lost <= 2.0 * half * rounding * steepest)
        # More pieces would not help: what is lost counts as error.
        if halving == MOST_HALVINGS or np.count_nonzero(~good) > most:
            good[:] = True
        starts.append(low[good])
        rows.append(series[good])
        error += float(np.sum(lost[good]))
        if np.all(good):
            break
        middle = 0.5 * (low + high)[~good]
        low = np.concatenate((low[~good], middle))
        high = np.concatenate((middle, high[~good]))
        order = np.argsort(low, kind="stable")
        low, high = low[order], high[order]
    ordered = np.concatenate(starts)
    order = np.argsort(ordered, kind="stable")
    return PiecewiseSeries(
        np.append(ordered[order], edges[-1]), np.concatenate(rows)[order].T, error, largest
    )


def series_values(series: FloatArray, x: FloatArray) -> FloatArray:
    """Sum of series[k] T_k(x), Clenshaw's recurrence; `series` (m, ...) and `x` broadcast."""
    double = 2.0 * x
    last = series[-1] + 0.0 * x
    previous = np.zeros_like(last)
    for row in series[-2:0:-1]:
        last, previous = row + double * last - previous, last
    value: FloatArray = series[0] + x * last - previous
    return value


SMALL: Final = 1.5
"""|kappa| up to which the recurrence is eliminated backwards. The pivots stay away from 0: their
zeros are those of the Bessel functions J_0, J_1 ..., of which 2.4 is the smallest."""

LARGE: Final = 64.0
"""|kappa| from which on the polynomial of the degree of a is taken: DEGREE^2 / 4, so that the k-th
derivative of T_16 by kappa^k, at most 256^k / (1 3 5 ... (2k - 1) 64^k), does not exceed 6."""

ORDER: Final = 24
"""Degree of Q on a cell with small |kappa|: exp(kappa x) needs 20 for 16 digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Q on the cells of one or more problems, a piece and a lambda each.

    Attributes
    ----------
    problem : (c,) the problem that each cell belongs to; the cells of a problem are consecutive.
    start, half : (c,) where the cell begins, and half its length.
    rate : (c,) lambda.
    series : (25, c) coefficients of Q.
    first : (c,) whether the cell is the first one of its piece.
    """

    problem: IntArray
    start: FloatArray
    half: FloatArray
    rate: ComplexArray
    series: ComplexArray
    first: BoolArray

    @property
    def at_start(self) -> ComplexArray:
        """(c,) Q(-1)."""
        even_sum: ComplexArray = np.sum(self.series[::2], axis=0)
        odd_sum: ComplexArray = np.sum(self.series[1::2], axis=0)
        return even_sum - odd_sum

    @property
    def growth(self) -> ComplexArray:
        """(c,) factor of a free vibration from the start of the cell to its end."""
        grown: ComplexArray = np.exp(2.0 * self.rate * self.half)
        return grown

    @property
    def gain(self) -> ComplexArray:
        """(c,) u at the end of the cell, if it is 0 at its start."""
        at_end: ComplexArray = np.sum(self.series, axis=0)
        return at_end - self.growth * self.at_start


def most_cells(pieces: int, rate: ComplexArray) -> FloatArray:
    """(q,) bounds of the number of cells over `pieces` of length 1 in all, for each lambda."""
    cut = np.minimum(np.abs(rate) * (0.5 / SMALL), pieces * (LARGE / SMALL))
    return np.asarray(pieces + cut)


def solve(pieces: PiecewiseSeries, piece: IntArray, rate: ComplexArray) -> Cells:
    """Q of the problems (q,): the `piece` of `pieces` and the lambda `rate` of each."""
    width = np.diff(pieces.edges)[piece]
    size = 0.5 * np.abs(rate) * width
    wide = size >= LARGE
    # In between, a piece is cut until |kappa| is small.
    parts = np.where(wide, 1.0, np.maximum(1.0, np.ceil(size / SMALL))).astype(np.intp)
    problem, number = grouped(parts)
    count = parts[problem].astype(np.float64)
    forcing = pieces.series[:, piece[problem]]
    cut = np.flatnonzero(count > 1.0)
    if len(cut):
        x = (2.0 * number[cut] + 1.0 + NODES[:, np.newaxis]) / count[cut] - 1.0
        # A part has its own series, from the values at its nodes.
        forcing[:, cut] = TO_SERIES @ series_values(forcing[:, cut], x)
    start = pieces.edges[:-1][piece][problem] + width[problem] * (number / count)
    half = 0.5 * width[problem] / count
    forcing *= half
    kappa = rate[problem] * half
    series = np.zeros((ORDER + 1, len(problem)), dtype=np.complex128)
    large = wide[problem]
    if np.any(large):
        series[: DEGREE + 1, large] = _downwards(kappa[large], forcing[:, large])
    if not np.all(large):
        series[:, ~large] = _eliminated(kappa[~large], forcing[:, ~large])
    return Cells(problem, start, half, rate[problem], series, number == 0)


def _downwards(kappa: ComplexArray, forcing: FloatArray) -> ComplexArray:
    """(17, c) the polynomial of the degree of `forcing`, H a."""
    q = np.zeros((DEGREE + 3, len(kappa)), dtype=np.complex128)
    padded = np.concatenate((forcing, np.zeros((2, len(kappa)))))
    inverse = 1.0 / kappa
    q[DEGREE] = -forcing[DEGREE] * inverse
    for k in range(DEGREE, 0, -1):
        c = 2.0 if k == 1 else 1.0
        known = 2.0 * k * q[k] - (c * padded[k - 1] - padded[k + 1])
        q[k - 1] = (known * inverse + q[k + 1]) / c
    series: ComplexArray = q[: DEGREE + 1]
    return series


def _eliminated(kappa: ComplexArray, forcing: FloatArray) -> ComplexArray:
    """(25, c) the solution with q_0 = 0: q_k = slope_k q_{k-1} + shift_k from the end back."""
    count = len(kappa)
    padded = np.zeros((ORDER + 2, count))
    padded[: DEGREE + 1] = forcing
    slope = np.zeros((ORDER + 2, count), dtype=np.complex128)
    q = np.zeros((ORDER + 2, count), dtype=np.complex128)  # the shifts, then the solution
    for k in range(ORDER, 0, -1):
        c = 2.0 if k == 1 else 1.0
        pivot = 1.0 / (2.0 * k + kappa * slope[k + 1])
        slope[k] = c * kappa * pivot
        q[k] = (c * padded[k - 1] - padded[k + 1] - kappa * q[k + 1]) * pivot
    for k in range(2, ORDER + 1):  # q_0 = 0 leaves q_1 as it is
        q[k] += slope[k] * q[k - 1]
    series: ComplexArray = q[: ORDER + 1]
    return series


@dataclass(frozen=True, eq=False)
class Mode:
    """u over the cells of one problem after the other, all with the same lambda.

    Attributes
    ----------
    edges : (c + 1,) borders of the cells.
    cells : Q.
    free : (c,) C.
    """

    edges: FloatArray
    cells: Cells
    free: ComplexArray

    @property
    def largest(self) -> float:
        """Bound of the magnitude of u."""
        return float(np.max(np.sum(np.abs(self.cells.series), axis=0) + np.abs(self.free)))

    def values(self, t: FloatArray, side: Side) -> ComplexArray:
        """(n,) u at `t` (n,) between the edges; from the side asked for where it jumps."""
        place = np.searchsorted(self.edges, t, side) - 1
        place = np.clip(place, 0, len(self.free) - 1)
        half = self.cells.half[place]
        way = (t - self.cells.start[place]) / half
        series = self._needed[place].T
        x = way - 1.0
        double = 2.0 * x
        last = series[-1].copy()
        previous = np.zeros_like(last)
        # Clenshaw's recurrence in place: the older of both arrays takes the new values.
        for row in series[-2:0:-1]:
            previous *= -1.0
            previous += row
            previous += double * last
            last, previous = previous, last
        u: ComplexArray = series[0] + x * last - previous
        u += self.free[place] * np.exp((self.cells.rate[0] * half) * way)
        return u

    @cached_property
    def _needed(self) -> ComplexArray:
        """(c, .) the coefficients up to the last that exceeds the rounding of the largest."""
        rows = np.max(np.abs(self.cells.series), axis=1)
        counts = np.flatnonzero(rows > np.finfo(np.float64).eps * 0.125 * np.max(rows))
        # The recurrence begins with two coefficients.
        count = max(int(counts[-1]) + 1 if len(counts) else 2, 2)
        return np.ascontiguousarray(self.cells.series[:count].T)


def total_gain(cells: Cells, jumps: FloatArray, end: float) -> complex:
    """u at `end` of all `cells`, if it is 0 before them and jumps by `jumps` (p,) at each piece."""
    until = end - cells.start
    kicks = np.zeros(len(cells.start))
    kicks[cells.first] = jumps
    # Each gain decays from the end of its cell on, each jump from its start on.
    rest = np.maximum(until - 2.0 * cells.half, 0.0)
    return complex(
        np.sum(np.exp(cells.rate * rest) * cells.gain) + np.sum(np.exp(cells.rate * until) * kicks)
    )


def follow_mode(cells: Cells, jumps: FloatArray, end: float, begin: complex) -> Mode:
    """The mode with the value `begin` at the start, before the first jump; see `total_gain`."""
    kicks = np.zeros(len(cells.start))
    kicks[cells.first] = jumps
    starts = []
    u = begin + kicks[0]
    for growth, gain, kick in zip(
        cells.growth.tolist(), cells.gain.tolist(), [*kicks.tolist()[1:], 0.0], strict=True
    ):
        starts.append(u)
        u = growth * u + gain + kick
    free = np.array(starts) - cells.at_start
    return Mode(np.append(cells.start, end), cells, free)


# -- spectrum -------------------------------------------------------------------------------------
# Shock spectrum: residual vibration after a move, over the ratio t_move / T_n.
#
# The train is one mass at rest before the move, T_n = 2 pi / w its natural period; the residual is
# the amplitude of the free vibration when the move ends, as a fraction of the stroke: |u(1)| / (w
# sqrt(1 - D^2)). With the largest deflection during the move, |Im u(t)| / (w sqrt(1 - D^2)) at its
# highest, it gives the maximax response (Neklutin's use of the spectrum for cams, see Rothbart, Cam
# Design Handbook, section 13.2; Norton, Cam Design and Manufacturing Handbook, chapter on residual
# vibrations).


BLOCK: Final = 16_384
"""Cells evaluated at a time, over all ratios, so that a block takes some tens of megabytes."""

QUIET: Final = 0.01
"""Share of the stroke below which a residual vibration counts as small."""

SAMPLES: Final = 64
"""Times a natural period at which the deflection during a move is evaluated."""


@dataclass(frozen=True, slots=True, eq=False)
class Shock:
    """A move by 1 in the time from 0 to 1, from rest to rest.

    Attributes
    ----------
    lift : the displacement from its start.
    end : its final value: 1, or less if it returns.
    pieces : minus its acceleration.
    kicks : (p + 1,) minus the jumps of its velocity at the edges of the pieces.
    """

    lift: PiecewiseSeries
    end: float
    pieces: PiecewiseSeries
    kicks: FloatArray

    def residual(self, ratios: FloatArray, damping: float = 0.0) -> FloatArray:
        """(n,) the residual at the ratios (n,), all above 0, with a damping ratio in [0, 1)."""
        ratios = np.asarray(ratios, dtype=np.float64)
        root = math.sqrt((1.0 - damping) * (1.0 + damping))
        frequency = 2.0 * math.pi * ratios
        rates = np.asarray(frequency * complex(-damping, root), dtype=np.complex128)
        gain = np.empty(len(rates), dtype=np.complex128)
        pieces = max(self.lift.series.shape[1], self.pieces.series.shape[1])
        # Consecutive ratios whose cells fit into a block together.
        blocks = np.cumsum(most_cells(pieces, rates)) // BLOCK
        ends = np.append(np.flatnonzero(np.diff(blocks)) + 1, len(rates))
        for first, end in pairwise((0, *ends.tolist())):
            block = rates[first:end]
            soft = np.abs(block) < SOFT
            part = gain[first:end]
            part[~soft] = self._gain(block[~soft])
            part[soft] = self._soft_gain(block[soft])
        remains: FloatArray = np.abs(gain) / (frequency * root)
        return remains

    def largest(self, ratios: FloatArray, damping: float = 0.0) -> FloatArray:
        """(n,) the largest deflection at the ratios (n,), as a fraction of the stroke, sampled.

        The residual, or the largest deflection during the move at `SAMPLES` times a natural period:
        the largest of a harmonic deflection is missed by at most 1 - cos(pi/SAMPLES), 0.1 %.
        """
        root = math.sqrt((1.0 - damping) * (1.0 + damping))
        count = self.pieces.series.shape[1]
        every = np.arange(count)
        deflections = self.residual(ratios, damping)
        for number, ratio in enumerate(np.asarray(ratios, dtype=np.float64).tolist()):
            frequency = 2.0 * math.pi * ratio
            rate = np.full(count, frequency * complex(-damping, root))
            mode = follow_mode(solve(self.pieces, every, rate), self.kicks[:-1], 1.0, 0j)
            times = np.linspace(0.0, 1.0, SAMPLES * math.ceil(max(ratio, 1.0)) + 1)
            deflection = np.abs(mode.values(times, "right").imag) / (frequency * root)
            deflections[number] = max(deflections[number], float(np.max(deflection)))
        return deflections

    def bound(self, ratio: float, damping: float = 0.0) -> float:
        """An upper bound of the residuals from `ratio` on.

        Integrated by parts once, the integral of exp(lambda (1 - t)) a is at most the variation of
        a, its jumps at the ends included, by |lambda|.
        """
        frequency = 2.0 * math.pi * ratio
        root = math.sqrt((1.0 - damping) * (1.0 + damping))
        x = np.linspace(-1.0, 1.0, 4 * len(NODES))[:, np.newaxis]
        # Padded by 0, so that the jumps at both ends count.
        values = np.pad(series_values(self.pieces.series, x).T.ravel(), 1)
        variation = float(np.sum(np.abs(np.diff(values))))
        return (variation / frequency + float(np.sum(np.abs(self.kicks)))) / (frequency * root)

    def _gain(self, rates: ComplexArray) -> ComplexArray:
        """(k,) u at the end."""
        gain = _gains(self.pieces, rates)
        for time, kick in zip(self.pieces.edges.tolist(), self.kicks.tolist(), strict=True):
            if kick != 0.0:
                gain += kick * np.exp(rates * (1.0 - time))
        return gain

    def _soft_gain(self, rates: ComplexArray) -> ComplexArray:
        """(k,) the same from the lift, see `camgeo.dynamics.oscillator.steady.SOFT`."""
        return -rates * (rates * _gains(self.lift, rates) + self.end)


def shock(
    lift: Callable[[FloatArray], FloatArray],
    acceleration: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    jumps: FloatArray,
    end: float = 1.0,
    rounding: float = 0.0,
) -> Shock:
    """The move with that `lift`, which is smooth between `edges` (m + 1,) from 0 to 1.

    `acceleration` is its second derivative, `jumps` (m + 1,) are those of its first one at the
    edges, `end` is the lift at the end, `rounding` the error with which they take their argument.
    """
    pieces = interpolated(lambda z: -acceleration(z), edges, FINEST, rounding)
    kicks = np.zeros(len(pieces.edges))
    kicks[np.searchsorted(pieces.edges, edges)] = -jumps
    return Shock(interpolated(lift, edges, FINEST, rounding), end, pieces, kicks)


def _gains(pieces: PiecewiseSeries, rates: ComplexArray) -> ComplexArray:
    """(k,) value at the end of all pieces of a mode that begins with 0, for each of `rates`."""
    count = pieces.series.shape[1]
    cells = solve(pieces, np.tile(np.arange(count), len(rates)), np.repeat(rates, count))
    # All pieces of one rate are problems in a row.
    owner = cells.problem // count
    rest = np.maximum(1.0 - cells.start - 2.0 * cells.half, 0.0)
    parts = np.exp(cells.rate * rest) * cells.gain
    real = np.bincount(owner, parts.real, len(rates))
    return np.asarray(real + 1j * np.bincount(owner, parts.imag, len(rates)))
