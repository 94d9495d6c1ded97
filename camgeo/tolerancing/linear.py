"""The error of the position by exact sensitivities, as independent sources add up.

Its extremes are sought between the angles where the motion has a kink, and are exact but for
rounding; shares of the variance and what is not linear are of the angles of the analysis.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.tolerancing.distribution import SIGMAS
from camgeo.tolerancing.freedoms import Deviations, Freedom
from camgeo.tolerancing.replay import replayed
from camgeo.tolerancing.sensitivity import Sensitivities
from camgeo.tolerancing.sources import Source
from camgeo.tolerancing.stated import Stated
from camgeo.units import TURN

ANGLES: Final = 360
"""Cam angles of a turn; the first of them is 0."""


def even_angles() -> FloatArray:
    """(ANGLES,) cam angles [rad]."""
    found: FloatArray = np.linspace(0.0, TURN, ANGLES + 1)[:-1]
    return found


@dataclass(frozen=True, slots=True)
class Contribution:
    """What one source does to the position.

    Attributes
    ----------
    source : what deviates.
    sensitivity : of the largest magnitude over the turn, error [mm or rad] per mm or rad; of a
        source with a random direction its amplitude, without sign.
    share : of the variance, averaged over the angles of the analysis.
    share_at_worst : of the variance where it is largest.
    remainder : how far the exact motion is off the linear one where the source deviates by three
        standard deviations, to either side; the largest at the angles of the analysis.
    """

    source: Source
    sensitivity: Extreme
    share: float
    share_at_worst: float
    remainder: Extreme

    @property
    def spread(self) -> Extreme:
        """The largest three standard deviations [mm or rad]."""
        sigma = math.sqrt(self.source.moments.variance)
        return Extreme(SIGMAS * sigma * abs(self.sensitivity.value), self.sensitivity.place)

    @property
    def mean(self) -> Extreme:
        """Error of the largest magnitude that all machines share."""
        value = self.source.moments.mean * self.sensitivity.value
        return Extreme(value + 0.0, self.sensitivity.place)


@dataclass(frozen=True, eq=False)
class Linear:
    """The linear analysis at cam angles.

    Attributes
    ----------
    stated : tolerances and machine.
    angles : (n,) cam angles [rad]; `ANGLES` of a turn, unless others are given.
    """

    stated: Stated
    angles: FloatArray = field(default_factory=even_angles)

    @cached_property
    def nominal(self) -> Sensitivities:
        """Of the nominal machine at these angles, and last at that at which the error is set to 0,
        if it is set.
        """
        at = self.stated.set_at
        phi = self.angles if at is None else np.append(self.angles, at)
        return Sensitivities(self.stated.machine, phi)

    def as_set(self, errors: FloatArray) -> FloatArray:
        """(..., n) errors after the machine has been set, from those of `nominal`."""
        if self.stated.set_at is None:
            return errors
        return np.asarray(errors[..., :-1] - errors[..., -1:])

    def sensitivity(self, source: Source) -> FloatArray:
        """(units, n) error [mm or rad] per unit."""
        return self.as_set(np.stack([self.nominal.of(unit) for unit in source.units]))

    @cached_property
    def sensitivities(self) -> tuple[FloatArray, ...]:
        """(units, n) of each source: error [mm or rad] per unit."""
        return tuple(map(self.sensitivity, self.stated.sources))

    @cached_property
    def variances(self) -> FloatArray:
        """(sources, n) of the error."""
        return np.stack(
            [source.moments.variance * np.sum(rows**2, axis=0) for source, rows in self._pairs]
        )

    @property
    def _pairs(self) -> list[tuple[Source, FloatArray]]:
        return list(zip(self.stated.sources, self.sensitivities, strict=True))

    @cached_property
    def mean(self) -> FloatArray:
        """(n,) mean error."""
        means = [each.moments.mean * np.sum(rows, axis=0) for each, rows in self._pairs]
        return np.asarray(self.at_rest + np.sum(means, axis=0))

    @property
    def at_rest(self) -> FloatArray:
        """(n,) of the nominal machine, which does not err."""
        return np.zeros(len(self.angles))

    @cached_property
    def sigma(self) -> FloatArray:
        """(n,) standard deviation of the error."""
        return np.asarray(np.sqrt(np.sum(self.variances, axis=0)))

    @cached_property
    def band(self) -> tuple[FloatArray, FloatArray]:
        """Mean less and plus three standard deviations, (n,) each."""
        return self.mean - SIGMAS * self.sigma, self.mean + SIGMAS * self.sigma

    # Over the turn --------------------------------------------------------------------------------

    @cached_property
    def _edges(self) -> FloatArray:
        """Cam angles [rad] between which sensitivities are smooth, and have few turning points.

        Where a machine is set on one of many waves, there are as many of these in a turn.
        """
        edges = self.stated.machine.cam.drive.smooth_angles
        if self.stated.set_at is None:
            return edges
        units = (unit for source in self.stated.sources for unit in source.units)
        waves = max(unit.freedom.waves for unit in units)
        return merged(np.concatenate((edges, np.linspace(0.0, TURN, waves + 1)[1:-1])))

    def _extremes(self, values: Callable[[Linear], FloatArray]) -> Extremes:
        """Over the turn, of `values` (n,) of an analysis; exact but for rounding."""

        def quantity(phi: FloatArray, _: Side) -> FloatArray:
            return values(replace(self, angles=phi))

        return piecewise_extremes(quantity, self._edges)

    @cached_property
    def worst(self) -> Extreme:
        """The error of the largest magnitude on the edges of the band, over the turn."""
        lowest = self._extremes(lambda each: each.band[0]).lowest
        return _larger(Extremes(lowest, self._extremes(lambda each: each.band[1]).highest))

    @cached_property
    def contributions(self) -> tuple[Contribution, ...]:
        """Of the sources, in the order of the scene."""
        place = self._extremes(lambda each: each.sigma).highest.place
        there = replace(self, angles=np.array([place])).variances[:, 0]
        mean = np.mean(self.variances, axis=1)
        return tuple(
            Contribution(
                source,
                self._largest_sensitivity(source),
                _share(float(mean[k]), float(np.sum(mean))),
                _share(float(there[k]), float(np.sum(there))),
                self.largest(self._remainder(source, rows)),
            )
            for k, (source, rows) in enumerate(self._pairs)
        )

    def _largest_sensitivity(self, source: Source) -> Extreme:
        """See `Contribution`."""

        def signed(each: Linear) -> FloatArray:
            rows = each.sensitivity(source)
            return np.asarray(rows[0] if len(rows) == 1 else np.hypot(*rows))

        return _larger(self._extremes(signed))

    # At the angles --------------------------------------------------------------------------------

    def largest(self, values: FloatArray) -> Extreme:
        """Of values (n,) that with the largest magnitude, and its cam angle."""
        place = int(np.argmax(np.abs(values)))
        return Extreme(float(values[place]) + 0.0, float(self.angles[place]))

    def errors(self, deviations: Deviations) -> FloatArray:
        """(m, n) of machines, by their exact motion."""
        position = replayed(self.nominal, deviations).position[0]
        return self.as_set(position - self.nominal.positions[0])

    def _remainder(self, source: Source, rows: FloatArray) -> FloatArray:
        """(n,) of the larger magnitude of both sides, see `Contribution`."""
        own, count = source.moments, len(self.angles)
        size = own.mean + SIGMAS * np.sqrt(own.variance) * np.array([1.0, -1.0])
        worst = np.zeros(count)
        for unit, row in zip(source.units, rows, strict=True):
            deviations = Deviations(2, {unit.freedom: size * unit.factor})
            try:
                errors = self.errors(deviations)
            except GeometryError as error:
                raise GeometryError(f"{source.name}: {error.message}", error.key) from error
            apart = errors - size[:, np.newaxis] * row
            worst = farther(worst, farther(*apart))
        return worst


def farther(one: FloatArray, other: FloatArray) -> FloatArray:
    """(n,) of two values (n,) each those of the larger magnitude."""
    return np.where(np.abs(other) > np.abs(one), other, one)


def _larger(found: Extremes) -> Extreme:
    """That of the larger magnitude."""
    lowest, highest = found.lowest, found.highest
    chosen = lowest if -lowest.value > highest.value else highest
    return Extreme(chosen.value + 0.0, chosen.place)


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else 0.0


def deviations_of(sources: tuple[Source, ...], numbers: list[FloatArray]) -> Deviations:
    """The machines that sources make with their `numbers`, (units, m) each."""
    values: dict[Freedom, ComplexArray] = {}
    for source, rows in zip(sources, numbers, strict=True):
        for unit, row in zip(source.units, rows, strict=True):
            values[unit.freedom] = values.get(unit.freedom, 0.0) + row * unit.factor
    return Deviations(numbers[0].shape[1], values)
