"""The error of the position by exact sensitivities, as independent sources add up."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.tolerancing.distribution import SIGMAS
from camgeo.tolerancing.freedoms import Deviations, Freedom
from camgeo.tolerancing.replay import replayed
from camgeo.tolerancing.sensitivity import Sensitivities
from camgeo.tolerancing.sources import Source
from camgeo.tolerancing.stated import Stated
from camgeo.units import TURN

ANGLES: Final = 360
"""Cam angles of a turn; the first of them is 0."""


@dataclass(frozen=True, slots=True)
class Contribution:
    """What one source does to the position.

    Attributes
    ----------
    source : what deviates.
    sensitivity : of the largest magnitude, error [mm or rad] per mm or rad; of a source with a
        random direction its amplitude, without sign.
    spread : the largest three standard deviations [mm or rad].
    mean : error of the largest magnitude that all machines share.
    share : of the variance, averaged over the turn.
    share_at_worst : of the variance where it is largest.
    remainder : how far the exact motion is off the linear one where the source deviates by three
        standard deviations, to either side.
    """

    source: Source
    sensitivity: Extreme
    spread: Extreme
    mean: Extreme
    share: float
    share_at_worst: float
    remainder: Extreme


@dataclass(frozen=True)
class Linear:
    """The linear analysis.

    Attributes
    ----------
    stated : tolerances and machine.
    """

    stated: Stated

    @cached_property
    def phi(self) -> FloatArray:
        """(n,) cam angles [rad], of which the last is that at which the error is set to 0, if it is
        set.
        """
        grid: FloatArray = np.linspace(0.0, TURN, ANGLES + 1)[:-1]
        at = self.stated.set_at
        return grid if at is None else np.append(grid, at)

    @cached_property
    def nominal(self) -> Sensitivities:
        """Of the nominal machine at these angles."""
        return Sensitivities(self.stated.machine, self.phi)

    def as_set(self, errors: FloatArray) -> FloatArray:
        """(..., ANGLES) errors after the machine has been set, from those at `phi`."""
        if self.stated.set_at is None:
            return errors
        return np.asarray(errors[..., :ANGLES] - errors[..., -1:])

    @property
    def angles(self) -> FloatArray:
        """(ANGLES,) cam angles [rad] of the results."""
        return self.phi[:ANGLES]

    @cached_property
    def sensitivities(self) -> tuple[FloatArray, ...]:
        """(units, ANGLES) of each source: error [mm or rad] per unit."""
        return tuple(
            self.as_set(np.stack([self.nominal.of(unit) for unit in source.units]))
            for source in self.stated.sources
        )

    @cached_property
    def variances(self) -> FloatArray:
        """(sources, ANGLES) of the error."""
        return np.stack([
            np.sum([m.variance * row**2 for m, row in zip(source.moments, rows, strict=True)], 0)
            for source, rows in self._pairs
        ])  # fmt: skip

    @cached_property
    def means(self) -> FloatArray:
        """(sources, ANGLES) of the error."""
        return np.stack([
            np.sum([m.mean * row for m, row in zip(source.moments, rows, strict=True)], 0)
            for source, rows in self._pairs
        ])  # fmt: skip

    @property
    def _pairs(self) -> list[tuple[Source, FloatArray]]:
        return list(zip(self.stated.sources, self.sensitivities, strict=True))

    @cached_property
    def mean(self) -> FloatArray:
        """(ANGLES,) mean error."""
        return np.asarray(np.sum(self.means, axis=0))

    @cached_property
    def sigma(self) -> FloatArray:
        """(ANGLES,) standard deviation of the error."""
        return np.asarray(np.sqrt(np.sum(self.variances, axis=0)))

    @cached_property
    def band(self) -> tuple[FloatArray, FloatArray]:
        """Mean less and plus three standard deviations, (ANGLES,) each."""
        return self.mean - SIGMAS * self.sigma, self.mean + SIGMAS * self.sigma

    @property
    def worst(self) -> Extreme:
        """The error of the largest magnitude on the edges of the band."""
        low, high = self.band
        return self.largest(farther(high, low))

    def largest(self, values: FloatArray) -> Extreme:
        """Of values (ANGLES,) that with the largest magnitude, and its cam angle."""
        place = int(np.argmax(np.abs(values)))
        return Extreme(float(values[place]) + 0.0, float(self.angles[place]))

    @cached_property
    def contributions(self) -> tuple[Contribution, ...]:
        """Of the sources, in the order of the scene."""
        total = np.sum(self.variances, axis=0)
        worst = int(np.argmax(total))
        whole = float(np.mean(total))
        found = []
        for k, (source, rows) in enumerate(self._pairs):
            single = len(rows) == 1
            found.append(
                Contribution(
                    source,
                    self.largest(rows[0] if single else np.hypot(*rows)),
                    self.largest(SIGMAS * np.sqrt(self.variances[k])),
                    self.largest(self.means[k]),
                    _share(float(np.mean(self.variances[k])), whole),
                    _share(float(self.variances[k][worst]), float(total[worst])),
                    self.largest(self._remainder(source, rows)),
                )
            )
        return tuple(found)

    def _remainder(self, source: Source, rows: FloatArray) -> FloatArray:
        """(ANGLES,) of the larger magnitude of both sides, see `Contribution`."""
        sizes = [m.mean + SIGMAS * np.sqrt(m.variance) * np.array([1.0, -1.0])
                 for m in source.moments]  # fmt: skip
        worst = np.zeros(ANGLES)
        for unit, size, row in zip(source.units, sizes, rows, strict=True):
            deviations = Deviations(2, {unit.freedom: size * unit.factor})
            try:
                position = replayed(self.nominal, deviations).position[0]
            except GeometryError as error:
                raise GeometryError(f"{source.name}: {error.message}", error.key) from error
            errors = self.as_set(position - self.nominal.positions[0])
            apart = errors - size[:, np.newaxis] * row
            worst = farther(worst, farther(*apart))
        return worst


def farther(one: FloatArray, other: FloatArray) -> FloatArray:
    """(n,) of two values (n,) each those of the larger magnitude."""
    return np.where(np.abs(other) > np.abs(one), other, one)


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else 0.0


def deviations_of(sources: tuple[Source, ...], numbers: list[FloatArray]) -> Deviations:
    """The machines that sources make with their `numbers`, (units, m) each."""
    values: dict[Freedom, ComplexArray] = {}
    for source, rows in zip(sources, numbers, strict=True):
        for unit, row in zip(source.units, rows, strict=True):
            values[unit.freedom] = values.get(unit.freedom, 0.0) + row * unit.factor
    return Deviations(numbers[0].shape[1], values)
