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
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.oscillator.mode import Mode, Pieces, followed, gain_over, interpolated, solve
from camgeo.numeric.oscillator.train import EPS, Reading, Train

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
        after = self.jet(self.edges[:-1], "right")[1]
        before = np.roll(self.jet(self.edges[1:], "left")[1], 1)
        return np.asarray(after - before)


@dataclass(frozen=True, slots=True, eq=False)
class Forcing:
    """The forcing of the modes: -y'' with the jumps of -y', or y itself, or the force p.

    Attributes
    ----------
    pieces : the forcing as series.
    jumps : (p,) jump of u at the start of each piece.
    soft : whether the forcing is y.
    """

    pieces: Pieces
    jumps: FloatArray
    soft: bool

    def gain(self, rate: complex, period: float) -> complex:
        """The value at the end of the turn of a mode that is 0 before the first jump."""
        count = self.pieces.series.shape[1]
        cells = solve(self.pieces, np.arange(count), np.full(count, rate))
        return gain_over(cells, self.jumps, period)

    def times(self, factor: float) -> Forcing:
        """`factor` times the forcing."""
        return Forcing(self.pieces.times(factor), factor * self.jumps, self.soft)

    def noise(self, period: float, frequency: float = 0.0) -> float:
        """Estimate of the error of the integral of forcing and exp(i `frequency` t)."""
        size = self.pieces.largest * period + float(np.sum(np.abs(self.jumps)))
        return self.pieces.error + ROUNDINGS * EPS * (1.0 + frequency * period) * size


def forcing_of(train: Train, base: Base, tolerance: float) -> Forcing:
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
        jumps[np.searchsorted(pieces.edges, base.edges[:-1])] = -base.jumps()
    return Forcing(pieces, jumps, soft)


def load_of(force: Callable[[FloatArray], FloatArray], edges: FloatArray, share: float) -> Forcing:
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
        return self.error_of(self.train.deflection(self.train.output))

    def error_of(self, reading: Reading) -> float:
        """Estimate of the largest error of `reading`, with the rounding of its weights."""
        found = float(np.sum(np.abs(reading.weights) * self.errors))
        if self.load is not None:
            found += float(np.sum(np.abs(reading.loaded) * self.loaded_errors))
        return found

    def states(self, t: FloatArray, side: Side) -> FloatArray:
        """(3, n) deflection e, its velocity e', and the acceleration x'' of the output.

        `t` (n,) in [0, period]. Only a jump of the base's velocity, which the damper feels, makes
        e' jump, and that or a jump of the load x''.
        """
        return self.states_of(self.train.output, t, side)

    def states_of(self, mass: int, t: FloatArray, side: Side) -> FloatArray:
        """`states` of the `mass`, counted from 0 at the base."""
        train = self.train
        readings = train.deflection(mass), train.velocity(mass), train.acceleration(mass)
        return self.read(readings, t, side)

    def forces(self, links: Sequence[int], t: FloatArray, side: Side) -> FloatArray:
        """(k, n) forces in the `links`, see `Train.force`."""
        return self.read([self.train.force(link) for link in links], t, side)

    def read(self, readings: Sequence[Reading], t: FloatArray, side: Side) -> FloatArray:
        """(k, n) the `readings` at `t` (n,)."""
        t = self._on_side(t, side)
        rates = self.train.rates
        weights = np.stack([each.weights for each in readings])
        slow = np.array([(each.lift, each.slope) for each in readings])
        if self.forcing.soft:
            # u = -(y' + lambda y + lambda^2 p) with p' = lambda p + y
            slow -= np.stack(
                (np.sum(weights * rates, axis=1), np.sum(weights, axis=1)), axis=1
            ).real
            weights = -weights * rates**2
        out = _summed(self.modes, weights, t, side)
        if np.any(slow):
            out += slow @ self.base.jet(t, side)[:2]
        if self.load is not None:
            loaded = np.stack([each.loaded + 0.0 * self.train.rates for each in readings])
            out += _summed(self.loaded, loaded, t, side)
            direct = np.array([each.direct for each in readings])
            if np.any(direct):
                out += np.multiply.outer(direct, self.load.pieces.values(t, side))
        return out

    def at_rest(self, reading: Reading, t: FloatArray, side: Side) -> FloatArray:
        """(n,) what of a `reading` is that of the load at `t` (n,), if it stays as it is there."""
        if self.load is None:
            return np.zeros(len(t))
        held = self.load.pieces.values(self._on_side(t, side), side)
        return np.asarray(self.train.yielding(reading) * held)

    def free_amplitude(self, t: FloatArray, side: Side) -> FloatArray:
        """(n,) amplitude of the free vibration of the output while the base rests, and the load
        stays as it is.

        For one mass |u| / (w sqrt(1 - D^2)) = sqrt(e^2 + (e' + D w e)^2 / (w^2 (1 - D^2))), the
        amplitude that then decays with exp(-D w t); for more masses the sum of all modes, which
        they reach together sooner or later. Modes that nearly coincide, around mu, are
        (a + b t) exp(mu t) together, and count as |a| + |b / Re mu|, which is not exceeded.
        """
        t = self._on_side(t, side)
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
            found = forcing.gain(1j * frequency, period)
            return 0.0j if abs(found) <= forcing.noise(period, frequency) else found / period

        own = content(self.forcing) * (frequency**2 if self.forcing.soft else 1.0)
        moved = self.train.transfer(frequency) * own
        if self.load is not None:
            moved += self.train.compliance(frequency) * content(self.load)
        return moved

    def _on_side(self, t: FloatArray, side: Side) -> FloatArray:
        period = self.base.period
        if side == "left":
            return np.where(t <= 0.0, period, t)
        return np.where(t >= period, 0.0, t)


def _summed(modes: Sequence[Mode], weights: ComplexArray, t: FloatArray, side: Side) -> FloatArray:
    """(k, n) Re sum w u at `t` (n,), with the `weights` (k, m) of the modes."""
    out = np.zeros((len(weights), len(t)))
    for mode, weight in zip(modes, weights.T, strict=True):
        u = mode.values(t, side)
        out += np.multiply.outer(weight.real, u.real) - np.multiply.outer(weight.imag, u.imag)
    return out


def steady_state(
    train: Train, base: Base, tolerance: float, load: Forcing | None = None
) -> Response:
    """The periodic response to the base, and to a force on the output.

    Parameters
    ----------
    tolerance : fraction of the magnitude of the forcing that its series may truncate, on average.
    load : see `load_of`, over the period of the base.

    Raises
    ------
    ResonanceError
        See `answered`.
    """
    return answered(train, base, forcing_of(train, base, tolerance), load)


def answered(train: Train, base: Base, forcing: Forcing, load: Forcing | None = None) -> Response:
    """The periodic response to the `forcing` of `base`, which is soft as it is for `train`, and to
    the `load`.

    Raises
    ------
    ResonanceError
        If an undamped mode coincides with a harmonic that base or load contain. If they do not
        contain it, the growing part is omitted: the mode is the limit for neighbouring frequencies.
    """
    own = _driven(train, forcing, base.period)
    if load is None:
        return Response(train, base, forcing, *own)
    return Response(train, base, forcing, *own, load, *_driven(train, load, base.period))


def _driven(train: Train, forcing: Forcing, period: float) -> tuple[tuple[Mode, ...], FloatArray]:
    """The modes with their errors; raises as `answered`."""
    count = forcing.pieces.series.shape[1]
    modes, errors = [], []
    noise = forcing.noise(period)
    for rate, drift, doubt in zip(
        train.rates.tolist(), train.drift.tolist(), train.doubt.tolist(), strict=True
    ):
        cells = solve(forcing.pieces, np.arange(count), np.full(count, rate))
        phase = ROUNDINGS * EPS * abs(rate) * period * drift
        gain = gain_over(cells, forcing.jumps, period)
        loss = abs(_loss(rate, period))
        if loss <= phase:
            if abs(gain) > forcing.noise(period, abs(rate) * drift):
                raise ResonanceError(abs(rate), round(abs(rate) * period / (2.0 * math.pi)))
            begin = _beside(forcing, rate, period)
            loss = 1.0
        else:
            begin = gain / _loss(rate, period)
        mode = followed(cells, forcing.jumps, period, begin)
        own = (noise + phase * mode.largest) * (1.0 + 1.0 / loss)
        own += ROUNDINGS * EPS * doubt * mode.largest
        errors.append(own * (abs(rate) ** 2 if forcing.soft else 1.0))
        modes.append(mode)
    return tuple(modes), np.array(errors)


def _loss(rate: complex, period: float) -> complex:
    """1 - exp(lambda T)."""
    return -complex(np.expm1(rate * period))


def _beside(forcing: Forcing, rate: complex, period: float) -> complex:
    """Limit of the initial value of a mode whose gain and loss vanish: Cauchy's mean value."""
    around = [
        rate + cmath.rect(1.0 / period, 2.0 * math.pi * (k + 0.5) / CIRCLE) for k in range(CIRCLE)
    ]
    return sum(forcing.gain(each, period) / _loss(each, period) for each in around) / CIRCLE
