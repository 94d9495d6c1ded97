"""The error of the position: by exact sensitivities, of random machines, and with play.

Its extremes are sought between the angles where the motion has a kink, and are exact but for
rounding; shares of the variance and what is not linear are of the angles of the analysis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE, INERTIA
from camgeo.errors import EffectError, GeometryError
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.studies.sweep.family import Sample
from camgeo.studies.tolerancing.replay import replayed
from camgeo.studies.tolerancing.sensitivity import Sensitivities
from camgeo.studies.tolerancing.sources import SIGMAS, Deviations, Freedom, Source, Way
from camgeo.studies.tolerancing.stated import Stated
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


# -- play -----------------------------------------------------------------------------------------
# The play of a follower between the two sides that hold it, and where they squeeze it.
#
# On each side the contact bounds the follower's coordinate q. With n the outward normal of the disc
# and L = n . dW/dq, a side of an inner flank lets q only grow where L > 0, and only fall where L <
# 0; an outer flank the other way round. Where the sides deviate by dq_1 and dq_2, the follower can
# move by
#
#     play = play_0 - (e_1 dq_1 + e_2 dq_2), e = +1 where the side holds it from below, or -1,
#
# play_0 that of the nominal machine: 0 between two discs, the breadth of a yoke less the width of
# its cam. Where it is negative, the sides squeeze the follower by as much: something must give way.


ROUNDING: Final = 1e-12
"""Of 1 mm at the base circle: where both sides differ by less, they do the same."""


@dataclass(frozen=True, eq=False)
class Play(Linear):
    """The linear analysis of the play [mm or rad of the follower], in place of the position's.

    It is of a machine whose follower two sides hold, and does not depend on how it is set.
    """

    @cached_property
    def _sides(self) -> tuple[Sensitivities, Sensitivities]:
        assert self.stated.second is not None
        machines = (self.stated.machine, self.stated.second)
        first, second = (Sensitivities(each, self.angles) for each in machines)
        return first, second

    @cached_property
    def _from_below(self) -> tuple[FloatArray, FloatArray]:
        """(n,) e of each side."""
        first, second = (
            -each.machine.flank.sign * np.sign(each.nominal.leverage) for each in self._sides
        )
        return first, second

    @property
    def at_rest(self) -> FloatArray:
        """(n,) play of the nominal machine."""
        cam = self.stated.machine.cam
        if cam.breadth is None:
            return np.zeros(len(self.angles))
        return cam.yoke_breadth - cam.breadth.width(self.angles)

    def sensitivity(self, source: Source) -> FloatArray:
        """(units, n) play per unit; the base radius moves the zero of the lift, and no side."""
        rows = np.zeros((len(source.units), len(self.angles)))
        for row, unit in zip(rows, source.units, strict=True):
            if unit.freedom.way is not Way.SETTING:
                parts = [side.of_follower(unit) for side in self._sides]
                row -= np.sum(np.multiply(self._from_below, parts), axis=0)
        follower = self.stated.machine.cam.follower
        rows[np.abs(rows) <= ROUNDING * follower.lift_scale / follower.base_radius] = 0.0
        return rows

    @cached_property
    def _edges(self) -> FloatArray:
        """As of the position, with those of the width of a yoke's cam."""
        breadth = self.stated.machine.cam.breadth
        edges = self.stated.machine.cam.drive.smooth_angles
        return edges if breadth is None else merged(np.concatenate((edges, breadth.borders)))

    @property
    def least(self) -> Extreme:
        """The least play, mean less three standard deviations, over the turn."""
        return self._extremes(lambda each: each.band[0]).lowest

    @property
    def most(self) -> Extreme:
        """The largest play, mean and three standard deviations, over the turn."""
        return self._extremes(lambda each: each.band[1]).highest

    def errors(self, deviations: Deviations) -> FloatArray:
        """(m, n) by which the play of machines is off, by the exact motion on each side."""
        off = np.zeros((deviations.count, len(self.angles)))
        for side, sign in zip(self._sides, self._from_below, strict=True):
            found = replayed(side, deviations)
            off -= sign * (found.follower[0] + found.zero - side.lifts[0])
        return off


# -- sampled --------------------------------------------------------------------------------------
# Random machines, each replayed exactly: quantiles of the error, and how many keep the limit.


COUNT: Final = 1024
"""Machines unless another number is stated: the quantiles of 1 % have ten machines beyond them."""

FEWEST: Final = 128
MOST: Final = 16384
"""Their errors take 50 MB."""

QUANTILES: Final = (0.01, 0.5, 0.99)

INSIDE: Final = 2.0**-54
"""Shares are at least this far from 0 and 1, where a normal distribution is infinite."""

BLOCK: Final = 1024
"""Machines of which all motions are held at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """Random machines.

    Attributes
    ----------
    linear : the analysis that they are compared with.
    seed : of what was drawn.
    errors : (machines, n) of the position [mm or rad].
    accelerations : (machines,) largest magnitude of the position's second derivative [mm or rad per
        rad^2] at the cam angles of the analysis.
    acceleration : that of the nominal machine.
    contact : the forces of the nominal machine; None if they are not known.
    forces : (machines, 2) smallest and largest contact force [N] of each; None likewise.
    plays : (machines, 2) least and largest play of each [mm or rad]; None on a single flank.
    """

    linear: Linear
    seed: int
    errors: FloatArray
    accelerations: FloatArray
    acceleration: float
    contact: ContactForces | None
    forces: FloatArray | None
    plays: FloatArray | None

    @property
    def count(self) -> int:
        """Machines."""
        return len(self.errors)

    @property
    def quantiles(self) -> FloatArray:
        """(3, n) errors below which the shares `QUANTILES` of all machines are."""
        found: FloatArray = np.quantile(self.errors, QUANTILES, axis=0)
        return found

    @property
    def worst(self) -> Extreme:
        """The quantile of the largest magnitude."""
        low, _, high = self.quantiles
        return self.linear.largest(farther(high, low))

    @property
    def sigma(self) -> Extreme:
        """The largest standard deviation over the cam angle."""
        return self.linear.largest(np.std(self.errors, axis=0))

    @property
    def largest(self) -> FloatArray:
        """(machines,) magnitudes of the largest error over the turn."""
        return np.asarray(np.max(np.abs(self.errors), axis=1))

    @property
    def kept(self) -> float | None:
        """Share of machines that keep the limit at all cam angles; None if there is no limit."""
        limit = self.linear.stated.limit
        return None if limit is None else float(np.mean(self.largest <= limit))

    @property
    def kept_error(self) -> float | None:
        """Standard error of that share, as if machines were drawn independently.

        By Laplace's rule of succession, so that a sample without failures has one too.
        """
        kept = self.kept
        if kept is None:
            return None
        share = (kept * self.count + 1.0) / (self.count + 2.0)
        return math.sqrt(share * (1.0 - share) / self.count)


def sampled(
    linear: Linear,
    count: int = COUNT,
    seed: int = 0,
    contact: ContactForces | None = None,
    play: Play | None = None,
) -> Sampled:
    """Random machines by a scrambled Sobol sequence; the same seed draws the same ones.

    Parameters
    ----------
    contact : forces of the nominal machine at the angles of the analysis, if they are known.
    play : between the two sides that hold the follower, if there are two.

    Raises
    ------
    GeometryError
        For a count or seed out of range; if a machine has no contact near the nominal one.
    """
    if not FEWEST <= count <= MOST:
        raise GeometryError(f"must be from {FEWEST} to {MOST:,}", "count", str(count))
    if not 0 <= seed < 2**63:
        raise GeometryError("must be a whole number from 0 to 2^63 - 1", "seed", str(seed))
    errors, accelerations, forces, plays = [], [], [], []
    angles = len(linear.angles)
    for machines in _machines(linear.stated.sources, count, seed):
        found = replayed(linear.nominal, machines)
        position = found.position
        if contact is not None:
            off = found.follower - linear.nominal.lifts[:3, np.newaxis]
            normal = contact.of(off[..., :angles], found.leverage[:, :angles])
            forces.append(np.stack((np.min(normal, axis=1), np.max(normal, axis=1)), axis=1))
        if play is not None:
            room = play.at_rest + play.errors(machines)
            plays.append(np.stack((np.min(room, axis=1), np.max(room, axis=1)), axis=1))
        errors.append(linear.as_set(position[0] - linear.nominal.positions[0]))
        accelerations.append(np.max(np.abs(position[2][:, :angles]), axis=1))
    nominal = float(np.max(np.abs(linear.nominal.positions[2][:angles])))
    return Sampled(
        linear,
        seed,
        np.concatenate(errors),
        np.concatenate(accelerations),
        nominal,
        contact,
        np.concatenate(forces) if forces else None,
        np.concatenate(plays) if plays else None,
    )


def _machines(sources: tuple[Source, ...], count: int, seed: int) -> Iterator[Deviations]:
    draws = [each.draws for each in sources]
    shares = Sample(count, "sobol", seed).shares(sum(draws)).T
    shares = np.clip(shares, INSIDE, 1.0 - INSIDE)
    ends = np.cumsum([0, *draws])
    for first in range(0, count, BLOCK):
        numbers = [
            each.numbers(shares[start:end, first : first + BLOCK])
            for each, start, end in zip(sources, ends, ends[1:], strict=False)
        ]
        yield deviations_of(sources, numbers)


# -- contact force ---------------------------------------------------------------------------------
# What deviating machines cost in contact force, if the scene asks for that effect.
#
# The normal force is that of the nominal machine, changed by the inertia of what is accelerated
# otherwise and by the leverage of the normal, which turns: with the mass M reduced to the follower,
# B the force on it per unit of normal force, and L the leverage,
#
#     N' = (N + M (dq'' omega^2 + dq' alpha) / B) L / L'.
#
# That springs and friction change too is left out: a spring gives way by the error of the position,
# a tiny part of the lift.


@dataclass(frozen=True, slots=True, eq=False)
class ContactForces:
    """On the flank that carries, at n cam angles; negative where that would have to pull.

    Attributes
    ----------
    nominal : (n,) normal force [N].
    per_velocity, per_acceleration : (n,) [N] per unit of q' and of q''.
    leverage : (n,) magnitude of L [1 or mm/rad].
    """

    nominal: FloatArray
    per_velocity: FloatArray
    per_acceleration: FloatArray
    leverage: FloatArray

    def of(self, off: FloatArray, leverage: FloatArray) -> FloatArray:
        """(m, n) [N] of machines whose q, q' and q'' are off by `off` (3, m, n), with the magnitude
        of their `leverage` (m, n).
        """
        inertia = self.per_velocity * off[1] + self.per_acceleration * off[2]
        return np.asarray((self.nominal + inertia) * (self.leverage / leverage))


def contact_forces(design: Design, flank: Flank, phi: FloatArray) -> ContactForces | None:
    """Of the nominal machine at `phi` (n,) [rad].

    None if the scene names no contact force or no inertia, if it states no speed, or if there is no
    contact force, which is a finding of the effect.
    """
    if not {CONTACT_FORCE, INERTIA} <= set(design.scene.effects):
        return None
    try:
        force = design.effects.result(CONTACT_FORCE)
        mass = design.effects.result(INERTIA).to_follower(phi, "right")
    except EffectError:
        return None
    course = design.effects.course(CONTACT_FORCE)
    if course is None:
        return None
    sense = -flank.sign
    omega, alpha = course.rates(phi)[:2]
    per = mass / force.bracket(phi, "right", sense)
    leverage = np.abs(design.cam.disc.pitch_curve.leverage(phi))
    nominal = sense * force.normal(phi, "right")
    return ContactForces(nominal, per * alpha, per * omega**2, leverage)
