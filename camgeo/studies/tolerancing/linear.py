"""The error of the position: by exact sensitivities, by replaying random machines, and the play.

Extremes of the linear analysis are searched for between the angles at which the motion has a kink,
and are exact except for rounding. Shares of the variance and nonlinear remainders are those at the
angles of the analysis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, singledispatch
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE, INERTIA
from camgeo.errors import EffectError, GeometryError
from camgeo.geometry.outline.path import Flank
from camgeo.geometry.pitch_curve import PitchCurve, curvature_slope
from camgeo.kinematics.mechanism.flat import FlatFollower
from camgeo.kinematics.mechanism.follower import Follower, WithRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, dot, merged
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.studies.sweep.family import Sample
from camgeo.studies.tolerancing.stated import (
    SIGMAS,
    Deviations,
    Freedom,
    Pose,
    Sensitivities,
    Source,
    StatedTolerances,
    Way,
)
from camgeo.units import TURN

ANGLES: Final = 360
"""Number of cam angles of a revolution; the first of them is 0."""


def analysis_angles() -> FloatArray:
    """(ANGLES,) equally spaced cam angles [rad] in [0, 2 pi)."""
    angles: FloatArray = np.linspace(0.0, TURN, ANGLES + 1)[:-1]
    return angles


@dataclass(frozen=True, slots=True)
class Contribution:
    """What one source contributes to the error of the position.

    Attributes
    ----------
    source : what deviates.
    sensitivity : the one of the largest magnitude over the revolution, error [mm or rad] per mm or
        rad; for a source with a random direction its amplitude, without sign.
    share : share of the variance, averaged over the angles of the analysis.
    share_at_worst : share of the variance at the angle where it is largest.
    remainder : the largest difference between exact and linear error where the source deviates by
        three standard deviations, to either side, at the angles of the analysis.
    """

    source: Source
    sensitivity: Extreme
    share: float
    share_at_worst: float
    remainder: Extreme

    @property
    def spread(self) -> Extreme:
        """Three standard deviations of the error [mm or rad] where they are largest."""
        sigma = math.sqrt(self.source.moments.variance)
        return Extreme(SIGMAS * sigma * abs(self.sensitivity.value), self.sensitivity.place)

    @property
    def mean(self) -> Extreme:
        """The systematic error, which all machines share, where its magnitude is largest."""
        value = self.source.moments.mean * self.sensitivity.value
        return Extreme(value + 0.0, self.sensitivity.place)


@dataclass(frozen=True, eq=False)
class Linear:
    """The linear analysis of the error of the position.

    Attributes
    ----------
    stated : tolerances and machine.
    angles : (n,) cam angles [rad] at which it is made; `ANGLES` equally spaced ones by default.
    """

    stated: StatedTolerances
    angles: FloatArray = field(default_factory=analysis_angles)

    @cached_property
    def nominal(self) -> Sensitivities:
        """The sensitivities of the nominal machine at `angles`.

        If the machine is set, the last column is at the angle at which its error is set to 0.
        """
        zero_angle = self.stated.zero_angle
        phi = self.angles if zero_angle is None else np.append(self.angles, zero_angle)
        return Sensitivities(self.stated.machine, phi)

    def as_set(self, errors: FloatArray) -> FloatArray:
        """(..., n) errors after the machine has been set, from those at the angles of `nominal`."""
        if self.stated.zero_angle is None:
            return errors
        return np.asarray(errors[..., :-1] - errors[..., -1:])

    def sensitivity(self, source: Source) -> FloatArray:
        """(units, n) error of the position [mm or rad] per unit of a source."""
        return self.as_set(np.stack([self.nominal.position_error(unit) for unit in source.units]))

    @cached_property
    def sensitivities(self) -> tuple[FloatArray, ...]:
        """The sensitivity (units, n) of each source, in the order of the scene."""
        return tuple(map(self.sensitivity, self.stated.sources))

    @cached_property
    def variances(self) -> FloatArray:
        """(sources, n) variance of the error by each source."""
        return np.stack(
            [source.moments.variance * np.sum(rows**2, axis=0) for source, rows in self._pairs]
        )

    @property
    def _pairs(self) -> list[tuple[Source, FloatArray]]:
        return list(zip(self.stated.sources, self.sensitivities, strict=True))

    @cached_property
    def mean(self) -> FloatArray:
        """(n,) mean error of all machines."""
        means = [source.moments.mean * np.sum(rows, axis=0) for source, rows in self._pairs]
        return np.asarray(self.nominal_values + np.sum(means, axis=0))

    @property
    def nominal_values(self) -> FloatArray:
        """(n,) values of the nominal machine, whose error is 0."""
        return np.zeros(len(self.angles))

    @cached_property
    def sigma(self) -> FloatArray:
        """(n,) standard deviation of the error."""
        return np.asarray(np.sqrt(np.sum(self.variances, axis=0)))

    @cached_property
    def band(self) -> tuple[FloatArray, FloatArray]:
        """Mean minus and mean plus three standard deviations, (n,) each."""
        return self.mean - SIGMAS * self.sigma, self.mean + SIGMAS * self.sigma

    # Over the turn --------------------------------------------------------------------------------

    @cached_property
    def _edges(self) -> FloatArray:
        """Cam angles [rad] between which sensitivities are smooth and have few turning points.

        The error of a machine that is set at one angle oscillates with the waves of the flank, so
        there are as many edges in a revolution as waves.
        """
        edges = self.stated.machine.cam.drive.smooth_angles
        if self.stated.zero_angle is None:
            return edges
        units = (unit for source in self.stated.sources for unit in source.units)
        waves = max(unit.freedom.waves for unit in units)
        return merged(np.concatenate((edges, np.linspace(0.0, TURN, waves + 1)[1:-1])))

    def _extremes(self, values: Callable[[Linear], FloatArray]) -> Extremes:
        """Extremes over the revolution of `values` (n,) of an analysis; exact but for rounding."""

        def quantity(phi: FloatArray, _: Side) -> FloatArray:
            return values(replace(self, angles=phi))

        return piecewise_extremes(quantity, self._edges)

    @cached_property
    def worst(self) -> Extreme:
        """The error of the largest magnitude on the edges of the band, over the revolution."""
        lowest = self._extremes(lambda each: each.band[0]).lowest
        return _larger(Extremes(lowest, self._extremes(lambda each: each.band[1]).highest))

    @cached_property
    def contributions(self) -> tuple[Contribution, ...]:
        """The contributions of the sources, in the order of the scene."""
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
            # Two units are the components of a random direction: their amplitude counts.
            rows = each.sensitivity(source)
            return np.asarray(rows[0] if len(rows) == 1 else np.hypot(*rows))

        return _larger(self._extremes(signed))

    # At the angles --------------------------------------------------------------------------------

    def largest(self, values: FloatArray) -> Extreme:
        """The value of the largest magnitude of `values` (n,), and its cam angle."""
        place = int(np.argmax(np.abs(values)))
        return Extreme(float(values[place]) + 0.0, float(self.angles[place]))

    def errors(self, deviations: Deviations) -> FloatArray:
        """(m, n) errors of machines by their exact motion."""
        position = replay_machines(self.nominal, deviations).position[0]
        return self.as_set(position - self.nominal.positions[0])

    def _remainder(self, source: Source, rows: FloatArray) -> FloatArray:
        """(n,) nonlinear remainder, of the larger magnitude to either side, see `Contribution`."""
        moments, count = source.moments, len(self.angles)
        size = moments.mean + SIGMAS * np.sqrt(moments.variance) * np.array([1.0, -1.0])
        # Each unit deviates alone: of a random direction, along either axis.
        worst = np.zeros(count)
        for unit, row in zip(source.units, rows, strict=True):
            deviations = Deviations(2, {unit.freedom: size * unit.factor})
            try:
                errors = self.errors(deviations)
            except GeometryError as error:
                raise GeometryError(f"{source.name}: {error.message}", error.key) from error
            remainders = errors - size[:, np.newaxis] * row
            worst = farther(worst, farther(*remainders))
        return worst


def farther(one: FloatArray, other: FloatArray) -> FloatArray:
    """(n,) the value of the larger magnitude of each pair."""
    return np.where(np.abs(other) > np.abs(one), other, one)


def _larger(extremes: Extremes) -> Extreme:
    """The extreme of the larger magnitude."""
    lowest, highest = extremes.lowest, extremes.highest
    chosen = lowest if -lowest.value > highest.value else highest
    return Extreme(chosen.value + 0.0, chosen.place)


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else 0.0


def machine_deviations(sources: tuple[Source, ...], numbers: list[FloatArray]) -> Deviations:
    """The deviations of m machines from the numbers (units, m) of each source."""
    values: dict[Freedom, ComplexArray] = {}
    for source, rows in zip(sources, numbers, strict=True):
        for unit, row in zip(source.units, rows, strict=True):
            # Sources in the same freedom add up.
            values[unit.freedom] = values.get(unit.freedom, 0.0) + row * unit.factor
    return Deviations(numbers[0].shape[1], values)


# -- play -----------------------------------------------------------------------------------------
# The play of a follower between the two sides that hold it, and where they squeeze it.
#
# On each side the contact bounds the follower's coordinate q. With the outward normal n of the disc
# and L = n . dW/dq, a side on an inner flank lets q only increase where L > 0 and only decrease
# where L < 0; on an outer flank it is the other way round. If the sides deviate by dq_1 and dq_2,
# the follower can move by
#
#     play = play_0 - (e_1 dq_1 + e_2 dq_2), e = +1 where the side bounds q from below, else -1,
#
# where play_0 is that of the nominal machine: 0 between two discs, and the breadth of a yoke less
# the width of its cam. Negative play squeezes the follower by as much: something must give way.


ROUNDING: Final = 1e-12
"""Sensitivities of the play below this, relative to the lift of 1 mm at the base circle, are
rounding: both sides move alike."""


@dataclass(frozen=True, eq=False)
class Play(Linear):
    """The linear analysis of the play [mm or rad of the follower] in place of the position's error.

    The follower is held by two sides. The play does not depend on how the machine is set.
    """

    @cached_property
    def _sides(self) -> tuple[Sensitivities, Sensitivities]:
        assert self.stated.second is not None
        machines = (self.stated.machine, self.stated.second)
        first, second = (Sensitivities(machine, self.angles) for machine in machines)
        return first, second

    @cached_property
    def _from_below(self) -> tuple[FloatArray, FloatArray]:
        """(n,) e of each side, +1 where it bounds the follower's coordinate from below, else -1."""
        first, second = (
            -side.machine.flank.sign * np.sign(side.nominal.leverage) for side in self._sides
        )
        return first, second

    @property
    def nominal_values(self) -> FloatArray:
        """(n,) play of the nominal machine."""
        cam = self.stated.machine.cam
        if cam.breadth is None:
            return np.zeros(len(self.angles))
        return cam.yoke_breadth - cam.breadth.width(self.angles)

    def sensitivity(self, source: Source) -> FloatArray:
        """(units, n) play per unit; 0 for the base radius, which only moves the zero of lift."""
        rows = np.zeros((len(source.units), len(self.angles)))
        for row, unit in zip(rows, source.units, strict=True):
            if unit.freedom.way is not Way.SETTING:
                parts = [side.follower_error(unit) for side in self._sides]
                row -= np.sum(np.multiply(self._from_below, parts), axis=0)
        follower = self.stated.machine.cam.follower
        rows[np.abs(rows) <= ROUNDING * follower.lift_scale / follower.base_radius] = 0.0
        return rows

    @cached_property
    def _edges(self) -> FloatArray:
        """The edges for the position, and those of the width of a yoke's cam."""
        breadth = self.stated.machine.cam.breadth
        edges = self.stated.machine.cam.drive.smooth_angles
        return edges if breadth is None else merged(np.concatenate((edges, breadth.borders)))

    @property
    def least(self) -> Extreme:
        """The least play over the revolution, of mean minus three standard deviations."""
        return self._extremes(lambda each: each.band[0]).lowest

    @property
    def most(self) -> Extreme:
        """The largest play over the revolution, of mean plus three standard deviations."""
        return self._extremes(lambda each: each.band[1]).highest

    def errors(self, deviations: Deviations) -> FloatArray:
        """(m, n) deviation of the play of machines, by the exact motion on each side."""
        play_errors = np.zeros((deviations.count, len(self.angles)))
        for side, sign in zip(self._sides, self._from_below, strict=True):
            motions = replay_machines(side, deviations)
            play_errors -= sign * (motions.follower[0] + motions.zero - side.lifts[0])
        return play_errors


# -- sampled --------------------------------------------------------------------------------------
# Random machines, each replayed exactly: quantiles of the error, and the share within the limit.


COUNT: Final = 1024
"""Number of machines unless another one is stated: ten of them are beyond a quantile of 1 %."""

FEWEST: Final = 128
MOST: Final = 16384
"""Least and largest number of machines; the errors of so many take 50 MB."""

QUANTILES: Final = (0.01, 0.5, 0.99)

INSIDE: Final = 2.0**-54
"""Least distance of shares from 0 and 1, where quantiles of a normal distribution are infinite."""

BLOCK: Final = 1024
"""Number of machines whose motions are in memory at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """Random machines, replayed exactly.

    Attributes
    ----------
    linear : the analysis with which they are compared.
    seed : of the random numbers.
    errors : (machines, n) errors of the position [mm or rad].
    accelerations : (machines,) largest magnitude of the position's second derivative [mm or rad per
        rad^2] at the cam angles of the analysis.
    acceleration : that of the nominal machine.
    contact : the forces of the nominal machine; None if they are not known.
    forces : (machines, 2) smallest and largest contact force of each [N]; None if not known.
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
        """Number of machines."""
        return len(self.errors)

    @property
    def quantiles(self) -> FloatArray:
        """(3, n) quantiles of the error, for the shares `QUANTILES` of all machines."""
        quantile_errors: FloatArray = np.quantile(self.errors, QUANTILES, axis=0)
        return quantile_errors

    @property
    def worst(self) -> Extreme:
        """The outer quantile of the largest magnitude over the cam angle."""
        low, _, high = self.quantiles
        return self.linear.largest(farther(high, low))

    @property
    def sigma(self) -> Extreme:
        """The largest standard deviation over the cam angle."""
        return self.linear.largest(np.std(self.errors, axis=0))

    @property
    def largest(self) -> FloatArray:
        """(machines,) largest magnitude of each machine's error over the revolution."""
        return np.asarray(np.max(np.abs(self.errors), axis=1))

    @property
    def share_in_limit(self) -> float | None:
        """Share of the machines within the limit at all cam angles; None without a limit."""
        limit = self.linear.stated.limit
        return None if limit is None else float(np.mean(self.largest <= limit))

    @property
    def share_error(self) -> float | None:
        """Standard error of that share, as if machines were drawn independently.

        It is estimated by Laplace's rule of succession, so that it is above 0 also for a sample
        without failures.
        """
        sample_share = self.share_in_limit
        if sample_share is None:
            return None
        share = (sample_share * self.count + 1.0) / (self.count + 2.0)
        return math.sqrt(share * (1.0 - share) / self.count)

    @staticmethod
    def draw(
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
        play : analysis of the play, if two sides hold the follower.

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
        # The angle at which the machine is set, the last one of `nominal`, only counts for errors.
        angles = len(linear.angles)
        for machines in _machines(linear.stated.sources, count, seed):
            motions = replay_machines(linear.nominal, machines)
            position = motions.position
            if contact is not None:
                follower_errors = motions.follower - linear.nominal.lifts[:3, np.newaxis]
                normal = contact.machine_forces(
                    follower_errors[..., :angles], motions.leverage[:, :angles]
                )
                forces.append(np.stack((np.min(normal, axis=1), np.max(normal, axis=1)), axis=1))
            if play is not None:
                room = play.nominal_values + play.errors(machines)
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
    """The deviations of random machines, in blocks of at most `BLOCK`."""
    draws = [source.draws for source in sources]
    shares = Sample(count, "sobol", seed).shares(sum(draws)).T
    shares = np.clip(shares, INSIDE, 1.0 - INSIDE)
    ends = np.cumsum([0, *draws])  # each source has dimensions of the sequence of its own
    for first in range(0, count, BLOCK):
        numbers = [
            source.numbers(shares[start:end, first : first + BLOCK])
            for source, start, end in zip(sources, ends, ends[1:], strict=False)
        ]
        yield machine_deviations(sources, numbers)


# -- contact force ---------------------------------------------------------------------------------
# The contact force of machines that deviate, if the scene names that effect.
#
# The normal force is that of the nominal machine, changed by the inertia forces of the deviating
# acceleration and by the leverage of the normal, which rotates. With the mass M reduced to the
# follower, the force B on it per unit of normal force, and the leverage L,
#
#     N' = (N + M (dq'' omega^2 + dq' alpha) / B) L / L'.
#
# Changes of spring forces and friction are neglected: a spring is deflected by the error of the
# position, which is a tiny part of the lift.


@dataclass(frozen=True, slots=True, eq=False)
class ContactForces:
    """Contact forces on the carrying flank at n cam angles; negative where it would have to pull.

    Attributes
    ----------
    nominal : (n,) normal force of the nominal machine [N].
    per_velocity, per_acceleration : (n,) force [N] per unit of q' and of q''.
    leverage : (n,) magnitude of L [1 or mm/rad].
    """

    nominal: FloatArray
    per_velocity: FloatArray
    per_acceleration: FloatArray
    leverage: FloatArray

    def machine_forces(self, errors: FloatArray, leverage: FloatArray) -> FloatArray:
        """(m, n) contact forces [N] of machines whose q, q' and q'' deviate by `errors` (3, m, n),
        with the magnitude of their `leverage` (m, n).
        """
        inertia = self.per_velocity * errors[1] + self.per_acceleration * errors[2]
        return np.asarray((self.nominal + inertia) * (self.leverage / leverage))


def contact_forces(design: Design, flank: Flank, phi: FloatArray) -> ContactForces | None:
    """The contact forces of the nominal machine at `phi` (n,) [rad].

    None if the scene does not name both contact force and inertia, if it states no speed, or if
    there is no contact force, which is a finding of the effect.
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


# -- replay ---------------------------------------------------------------------------------------
# The motion of machines that deviate, on the flank with which their cam was made.
#
# At each cam angle two equations are solved by Newton's method, for the parameter u of the place on
# the flank and the lift q. The centre of a roller lies on the curve of `FlankCurve`, R(u) = W(q). A
# flat face, a line through W(q) with the normal n(q), is tangent to it,
#
#     n . (R(u) - W(q)) = 0, n . R'(u) = 0.
#
# Velocity and acceleration follow by differentiating these along the cam angle.


STEPS: Final = 20
"""Largest number of Newton's steps; three or four are needed."""

SETTLED: Final = 1e-13
"""Last step of the lift, relative to the base radius or to 1 rad; the remaining error is of the
order of its square."""

FARTHEST: Final = 0.5
"""How far [rad] the contact may move along the flank; beyond, it would be another contact."""

AT_ONCE: Final = 16384
"""Largest product of machines and cam angles that are computed together."""

LOST: Final = (
    "a machine within the tolerances has no contact near the nominal one, at cam angle {:.6g} deg:"
    " the tolerances are too large"
)

HOLLOW: Final = (
    "a flat face cannot touch all of a flank that waves make hollow: make them lower, or fewer"
)


@dataclass(frozen=True, slots=True, eq=False)
class CamPoints:
    """Places on the flank at cam angles: R and its derivatives by the parameter of the flank.

    Attributes
    ----------
    place, along, bend : (m, n) R, dR/du and d^2R/du^2 in the frame [mm].
    spin : i sigma, the rate of rotation of the cam.
    axis : (m, 1) the cam axis [mm].
    """

    place: ComplexArray
    along: ComplexArray
    bend: ComplexArray
    spin: complex
    axis: ComplexArray

    @property
    def sweep(self) -> ComplexArray:
        """(m, n) dR/dphi [mm/rad]."""
        return self.spin * (self.place - self.axis)


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """Contact of a roller: its centre lies on the curve.

    Attributes
    ----------
    pose : motion of the roller's centre with the lift.
    """

    pose: Pose

    def require_reach(self, cam: CamPoints) -> None:
        """Raise GeometryError if the follower cannot touch the curve at some of these places.

        A roller can, wherever the curve is smooth.
        """

    def step(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Newton's steps (m, n) of u and of q."""
        place = self.pose.place(q)
        speed = self.pose.velocity(place)
        gap = cam.place - place
        # Across the curve only the lift closes the gap; along it, u takes up the rest.
        normal, pace = _normal(cam.along)
        dq = dot(normal, gap) / dot(normal, speed)
        du = dot(cam.along, dq * speed - gap) / (pace * pace)
        return du, dq

    def rates(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(m, n) first and second derivative of the lift by the cam angle, and the magnitude of
        n . dW/dq [1 or mm/rad].
        """
        place = self.pose.place(q)
        speed, swerve = self.pose.velocity(place), self.pose.acceleration(place)
        normal, pace = _normal(cam.along)
        steep = dot(normal, speed)
        first = dot(normal, cam.sweep) / steep
        du = dot(cam.along, first * speed - cam.sweep) / (pace * pace)
        # The centripetal, Coriolis and curvature terms of the point of contact on the turning cam.
        rest = -(cam.place - cam.axis) + 2.0 * cam.spin * cam.along * du + cam.bend * du * du
        second = dot(normal, rest - swerve * first * first) / steep
        return first, second, np.abs(steep)

    def radius(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distance from the origin [mm], as for the base radius, and its rate by the lift."""
        place = self.pose.place(q)
        size = np.abs(place)
        return size, dot(place, self.pose.velocity(place)) / size


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """Contact of a flat face: it is tangent to the curve.

    Attributes
    ----------
    pose : motion of a point on the face with the lift.
    normal : (1, 1) or (m, 1) normal of the face at lift 0, pointing away from the cam axis.
    """

    pose: Pose
    normal: ComplexArray

    def require_reach(self, cam: CamPoints) -> None:
        """See `Rolling`: the curve, with n = i sigma t along it, has to be convex everywhere."""
        if not np.all(dot(cam.spin * cam.along, cam.bend) < 0.0):
            raise GeometryError(HOLLOW)

    def step(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Rolling`."""
        normal = self.normal * self.pose.turn_factor(q)
        turning = 1j * self.pose.spin * normal  # dn/dq
        # Solve the linear system of both equations for du and dq by Cramer's rule.
        gap = dot(normal, cam.place - self.pose.place(q))
        closing = -dot(normal, self.pose.velocity(cam.place))
        slope, tilt = dot(normal, cam.along), dot(turning, cam.along)
        bend = dot(normal, cam.bend)
        det = slope * tilt - closing * bend
        du = (closing * slope - tilt * gap) / det
        dq = (bend * gap - slope * slope) / det
        return du, dq

    def rates(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `Rolling`."""
        normal = self.normal * self.pose.turn_factor(q)
        turning = 1j * self.pose.spin * normal
        closing = -dot(normal, self.pose.velocity(cam.place))
        first = -dot(normal, cam.sweep) / closing
        tilt = dot(turning, cam.along)
        swept = dot(normal, cam.spin * cam.along)
        bend = dot(normal, cam.bend)
        if not np.all(bend < 0.0):
            raise GeometryError(HOLLOW)
        du = -(swept + tilt * first) / bend
        pull = dot(turning, self.pose.velocity(cam.place))
        second = -dot(normal, cam.place - cam.axis) + swept * du
        second += 2.0 * dot(turning, cam.sweep) * first + tilt * du * first - pull * first * first
        return first, -second / closing, np.abs(closing)

    def radius(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Rolling`."""
        normal = self.normal * self.pose.turn_factor(q)
        place = self.pose.place(q)
        rate = dot(normal, self.pose.velocity(place))
        return dot(normal, place), rate + dot(1j * self.pose.spin * normal, place)


Contact = Rolling | Flat


@singledispatch
def follower_contact(follower: Follower, pose: Pose, deviations: Deviations) -> Contact:
    """How the followers (m, ...) of machines touch the cam; `pose` is the nominal one."""
    del pose, deviations  # used by the registered ones
    message = f'of the kind "{follower.kind}" cannot be analysed for tolerances'
    raise GeometryError(message, key="follower.kind")


@follower_contact.register
def _(_: WithRoller, pose: Pose, deviations: Deviations) -> Contact:
    return Rolling(_deviating_pose(pose, deviations))


@follower_contact.register
def _(follower: FlatFollower, pose: Pose, deviations: Deviations) -> Contact:
    normal = follower.normal(np.zeros(1))[np.newaxis]
    turn = np.exp(1j * deviations.real(Way.TILT))
    return Flat(_deviating_pose(pose, deviations), normal * turn)


def _deviating_pose(pose: Pose, deviations: Deviations) -> Pose:
    """The pose of the followers (m, ...) of machines."""
    # The shaft takes its rocker along, on which the body deviates; the tilt rotates all of it.
    held = pose.moved(deviations.amounts(Way.PIVOT), whole=True).moved(deviations.amounts(Way.BODY))
    return held.rotated(np.exp(1j * deviations.real(Way.TILT)))


@dataclass(frozen=True, slots=True, eq=False)
class MachineMotions:
    """The motions of m machines at n cam angles; derivatives are by the cam angle [rad].

    Attributes
    ----------
    follower : (3, m, n) lift of the follower [mm or rad] and two derivatives, counted from `zero`.
    position : (3, m, n) the same of the far end of a linkage, or of the follower without a linkage.
    leverage : (m, n) magnitude of n . dW/dq [1 or mm/rad].
    zero : (m, 1) lift at the deviating base radius, counted from the nominal zero.
    """

    follower: FloatArray
    position: FloatArray
    leverage: FloatArray
    zero: FloatArray


def replay_machines(nominal: Sensitivities, deviations: Deviations) -> MachineMotions:
    """The exact motions of machines that deviate.

    Raises
    ------
    GeometryError
        If a machine has no contact near the nominal one, if its follower undercuts, or if its
        linkage does not close.
    """
    machine = nominal.machine
    deviations = deviations.side_deviations(machine.hold, half_turn=machine.half_turn)
    size = max(1, AT_ONCE // len(nominal.phi))
    parts = []
    for first in range(0, deviations.count, size):
        some = {key: values[first : first + size] for key, values in deviations.values.items()}
        count = min(size, deviations.count - first)
        parts.append(_block(nominal, Deviations(count, some)))
    return MachineMotions(
        np.concatenate([part.follower for part in parts], axis=1),
        np.concatenate([part.position for part in parts], axis=1),
        np.concatenate([part.leverage for part in parts]),
        np.concatenate([part.zero for part in parts]),
    )


def _block(nominal: Sensitivities, deviations: Deviations) -> MachineMotions:
    """The exact motions of a block of machines."""
    machine = nominal.machine
    follower = machine.cam.follower
    contact = follower_contact(follower, machine.pose, deviations)
    lifts, leverage = _follower(nominal, deviations, contact)
    # The lift is counted from where a nominal follower is at the deviating base radius.
    zero = _setting(
        follower_contact(follower, machine.pose, Deviations(1, {})), deviations, follower
    )
    lifts[0] -= zero
    if nominal.far_end is None:
        return MachineMotions(lifts, lifts, leverage, zero)
    start = np.broadcast_to(nominal.positions[0], lifts[0].shape)
    position = nominal.far_end.deviating(deviations).follow(lifts, start)
    return MachineMotions(lifts, position, leverage, zero)


def _follower(
    nominal: Sensitivities, deviations: Deviations, contact: Contact
) -> tuple[FloatArray, FloatArray]:
    """(3, m, n) lift and two derivatives, counted from the nominal zero; and (m, n) leverage."""
    machine, phi = nominal.machine, nominal.phi
    disc = machine.cam.disc
    curve = FlankCurve(disc.pitch_curve, deviations)
    spin = 1j * disc.rotation
    # The disc runs ahead of its shaft by the error of timing.
    turn = np.exp(spin * (phi + deviations.real(Way.TIMING)))
    seat, axis = deviations.amounts(Way.SEAT), deviations.amounts(Way.SHAFT)
    shape = (deviations.count, len(phi))
    u = np.broadcast_to(phi, shape) + deviations.real(Way.TIMING)
    # The nominal contact is the start, so that the solution is the contact next to it.
    q = np.broadcast_to(nominal.lifts[0], shape).copy()
    scale = SETTLED * machine.cam.follower.lift_scale
    last = np.inf
    for _ in range(STEPS):
        point, along, bend = curve.jet(u)
        cam = CamPoints(axis + turn * (point + seat), turn * along, turn * bend, spin, axis)
        if last == np.inf:
            contact.require_reach(cam)
        if last <= scale:
            first, second, leverage = contact.rates(cam, q)
            return np.stack((q, first, second)), leverage
        with np.errstate(divide="ignore", invalid="ignore"):
            du, dq = contact.step(cam, q)
        u, q = u + du, q + dq
        lost = ~(np.abs(u - phi) < FARTHEST)  # true for NaN, too
        if np.any(lost):
            break
        last = max(float(np.max(np.abs(dq))), float(np.max(np.abs(du))) ** 2)
    excess = np.where(np.any(lost), lost, np.abs(dq))  # if none is lost, some did not converge
    place = float(np.degrees(phi[int(np.argmax(np.max(excess, axis=0)))]))
    raise GeometryError(LOST.format(place))


def _setting(nominal: Contact, deviations: Deviations, follower: Follower) -> FloatArray:
    """(m, 1) lifts of the nominal follower at which its radius is the deviating base radius."""
    aimed = follower.base_radius + deviations.real(Way.SETTING)
    q = np.zeros_like(aimed)
    if not np.any(deviations.real(Way.SETTING)):
        return q
    for _ in range(STEPS):
        radius, rate = nominal.radius(q)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = (aimed - radius) / rate
        q = q + step
        if np.all(np.abs(step) <= SETTLED * follower.lift_scale):
            return q
    message = "a machine within the tolerances would have one that its follower cannot reach"
    raise GeometryError(message, key="follower.base_radius")


def _normal(along: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Unit normals of a curve, on an arbitrary side, and the magnitude of `along`."""
    pace = np.abs(along)
    return 1j * along / pace, pace


# -- flank curve ----------------------------------------------------------------------------------
# The curve on which machines touch the cam: the pitch curve, offset by growth and waves.
#
# With the pitch curve Z(u), its unit tangent t and normal N = i sigma t, its speed v = |Z'| and its
# curvature kappa, the derivatives of P = Z + c N are
#
#     P'  = v (1 + c kappa) t + c' N,
#     P'' = (v' (1 + c kappa) + v c kappa' + 2 v c' kappa) t + (c'' - v^2 kappa (1 + c kappa)) N.


@dataclass(frozen=True, slots=True, eq=False)
class FlankCurve:
    """The offset pitch curves of m machines.

    Attributes
    ----------
    pitch : the nominal pitch curve.
    deviations : of the machines.
    """

    pitch: PitchCurve
    deviations: Deviations

    def jet(self, u: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """(m, n) each: P [mm] and two derivatives at the parameters u (m, n) [rad].

        Raises
        ------
        GeometryError
            Where a roller that is too large, or a wave, undercuts.
        """
        pitch, angles = self.pitch, u.ravel()
        follower, rotation = pitch.follower, pitch.rotation
        motion = pitch.motion.jet(angles)
        relative = follower.relative_jet(motion, rotation, 2)
        jet = pitch.in_cam(relative, angles, relative.along[:3], relative.across[:3])
        z, z1, z2 = jet.reshape(3, *u.shape)
        grown = self._growth(u)
        if grown is None:
            return z, z1, z2
        c, c1, c2 = grown
        v = np.abs(z1)
        kappa = follower.curvature(relative, v.ravel(), rotation).reshape(u.shape)
        slope = curvature_slope(follower.tangent_jet(motion, rotation), rotation).reshape(u.shape)
        t = z1 / v
        normal = 1j * rotation * t
        whole = 1.0 + c * kappa
        if not np.all(whole > 0.0):
            raise GeometryError(
                "within the tolerances the follower undercuts: a larger roller or a wave of the"
                " flank leaves no smooth curve; make the tolerances, or the waves, smaller"
            )
        first = v * whole * t + c1 * normal
        second = (dot(t, z2) * whole + v * c * slope + 2.0 * v * c1 * kappa) * t
        second += (c2 - v * v * kappa * whole) * normal
        return z + c * normal, first, second

    def _growth(self, u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """The offset c [mm] and two derivatives, (m, n) each; None if it is 0 everywhere."""
        growth, waves = self.deviations.real(Way.GROWTH), self.deviations.waves
        if not waves and not np.any(growth):
            return None
        c, c1, c2 = growth + np.zeros_like(u), np.zeros_like(u), np.zeros_like(u)
        for k, amplitude in waves.items():
            wave = amplitude * np.exp(-1j * k * u)
            c += wave.real
            c1 += k * wave.imag
            c2 -= k * k * wave.real
        return c, c1, c2
