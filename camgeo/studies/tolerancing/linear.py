"""The error of the position: by exact sensitivities, of random machines replayed, and with play.

Its extremes are sought between the angles where the motion has a kink, and are exact but for
rounding; shares of the variance and what is not linear are of the angles of the analysis.
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
"""Cam angles of a turn; the first of them is 0."""


def analysis_angles() -> FloatArray:
    """(ANGLES,) cam angles [rad]."""
    angles: FloatArray = np.linspace(0.0, TURN, ANGLES + 1)[:-1]
    return angles


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

    stated: StatedTolerances
    angles: FloatArray = field(default_factory=analysis_angles)

    @cached_property
    def nominal(self) -> Sensitivities:
        """Of the nominal machine at these angles, and last at that at which the error is set to 0,
        if it is set.
        """
        zero_angle = self.stated.zero_angle
        phi = self.angles if zero_angle is None else np.append(self.angles, zero_angle)
        return Sensitivities(self.stated.machine, phi)

    def as_set(self, errors: FloatArray) -> FloatArray:
        """(..., n) errors after the machine has been set, from those of `nominal`."""
        if self.stated.zero_angle is None:
            return errors
        return np.asarray(errors[..., :-1] - errors[..., -1:])

    def sensitivity(self, source: Source) -> FloatArray:
        """(units, n) error [mm or rad] per unit."""
        return self.as_set(np.stack([self.nominal.position_error(unit) for unit in source.units]))

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
        means = [source.moments.mean * np.sum(rows, axis=0) for source, rows in self._pairs]
        return np.asarray(self.nominal_values + np.sum(means, axis=0))

    @property
    def nominal_values(self) -> FloatArray:
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
        if self.stated.zero_angle is None:
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
        position = replay_machines(self.nominal, deviations).position[0]
        return self.as_set(position - self.nominal.positions[0])

    def _remainder(self, source: Source, rows: FloatArray) -> FloatArray:
        """(n,) of the larger magnitude of both sides, see `Contribution`."""
        moments, count = source.moments, len(self.angles)
        size = moments.mean + SIGMAS * np.sqrt(moments.variance) * np.array([1.0, -1.0])
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
    """(n,) of two values (n,) each those of the larger magnitude."""
    return np.where(np.abs(other) > np.abs(one), other, one)


def _larger(extremes: Extremes) -> Extreme:
    """That of the larger magnitude."""
    lowest, highest = extremes.lowest, extremes.highest
    chosen = lowest if -lowest.value > highest.value else highest
    return Extreme(chosen.value + 0.0, chosen.place)


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else 0.0


def machine_deviations(sources: tuple[Source, ...], numbers: list[FloatArray]) -> Deviations:
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
        first, second = (Sensitivities(machine, self.angles) for machine in machines)
        return first, second

    @cached_property
    def _from_below(self) -> tuple[FloatArray, FloatArray]:
        """(n,) e of each side."""
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
        """(units, n) play per unit; the base radius moves the zero of the lift, and no side."""
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
        play_errors = np.zeros((deviations.count, len(self.angles)))
        for side, sign in zip(self._sides, self._from_below, strict=True):
            motions = replay_machines(side, deviations)
            play_errors -= sign * (motions.follower[0] + motions.zero - side.lifts[0])
        return play_errors


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
        quantile_errors: FloatArray = np.quantile(self.errors, QUANTILES, axis=0)
        return quantile_errors

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
    def share_in_limit(self) -> float | None:
        """Share of machines that keep the limit at all cam angles; None if there is no limit."""
        limit = self.linear.stated.limit
        return None if limit is None else float(np.mean(self.largest <= limit))

    @property
    def share_error(self) -> float | None:
        """Standard error of that share, as if machines were drawn independently.

        By Laplace's rule of succession, so that a sample without failures has one too.
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
    draws = [source.draws for source in sources]
    shares = Sample(count, "sobol", seed).shares(sum(draws)).T
    shares = np.clip(shares, INSIDE, 1.0 - INSIDE)
    ends = np.cumsum([0, *draws])
    for first in range(0, count, BLOCK):
        numbers = [
            source.numbers(shares[start:end, first : first + BLOCK])
            for source, start, end in zip(sources, ends, ends[1:], strict=False)
        ]
        yield machine_deviations(sources, numbers)


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

    def machine_forces(self, errors: FloatArray, leverage: FloatArray) -> FloatArray:
        """(m, n) contact forces [N] of machines whose q, q' and q'' deviate by `errors` (3, m, n),
        with the magnitude of their `leverage` (m, n).
        """
        inertia = self.per_velocity * errors[1] + self.per_acceleration * errors[2]
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


# -- replay ---------------------------------------------------------------------------------------
# The motion of machines that deviate, on the flank that their cam was made with.
#
# At each cam angle two equations are solved by Newton's method, for the parameter u of the place on
# the flank and the lift q: the centre of a roller lies on the curve of `FlankCurve`, R(u) = W(q); a
# flat face, a line through W(q) with the normal n(q), touches it,
#
#     n . (R(u) - W(q)) = 0, n . R'(u) = 0.
#
# Velocity and acceleration follow by differentiating these along the cam angle.


STEPS: Final = 20
"""Of Newton's method, which needs three or four."""

SETTLED: Final = 1e-13
"""Last step of the lift, relative to the base radius or to 1 rad; what remains is its square."""

FARTHEST: Final = 0.5
"""How far [rad] the contact may move along the flank: beyond, it is another one."""

AT_ONCE: Final = 16384
"""Machines times cam angles that are computed together."""

LOST: Final = (
    "a machine within the tolerances has no contact near the nominal one, at cam angle {:.6g} deg:"
    " the tolerances are too large"
)

HOLLOW: Final = (
    "a flat face cannot touch all of a flank that waves make hollow: make them lower, or fewer"
)


@dataclass(frozen=True, slots=True, eq=False)
class CamPoints:
    """The cam at cam angles: R and its derivatives along the flank, and with the cam angle.

    Attributes
    ----------
    place, along, bend : (m, n) R, dR/du and d^2R/du^2 [mm].
    spin : i sigma, with which the cam turns.
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
    """How a roller touches the curve: its centre lies on it.

    Attributes
    ----------
    pose : of the roller centre.
    """

    pose: Pose

    def require_reach(self, cam: CamPoints) -> None:
        """GeometryError if the follower cannot touch the curve at all of these places: a roller
        can, wherever the curve is smooth.
        """

    def step(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Newton's steps of u and q (m, n)."""
        place = self.pose.place(q)
        speed = self.pose.velocity(place)
        gap = cam.place - place
        normal, pace = _normal(cam.along)
        dq = dot(normal, gap) / dot(normal, speed)
        du = dot(cam.along, dq * speed - gap) / (pace * pace)
        return du, dq

    def rates(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(m, n) velocity and acceleration of the lift, per unit of the cam angle, and the
        magnitude of n . dW/dq [1 or mm/rad].
        """
        place = self.pose.place(q)
        speed, swerve = self.pose.velocity(place), self.pose.acceleration(place)
        normal, pace = _normal(cam.along)
        steep = dot(normal, speed)
        first = dot(normal, cam.sweep) / steep
        du = dot(cam.along, first * speed - cam.sweep) / (pace * pace)
        rest = -(cam.place - cam.axis) + 2.0 * cam.spin * cam.along * du + cam.bend * du * du
        second = dot(normal, rest - swerve * first * first) / steep
        return first, second, np.abs(steep)

    def radius(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distance [mm] from the origin, as of the base radius, and its rate with the lift."""
        place = self.pose.place(q)
        size = np.abs(place)
        return size, dot(place, self.pose.velocity(place)) / size


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """How a flat face touches the curve: it is tangent to it.

    Attributes
    ----------
    pose : of a point on the face.
    normal : (1, 1) or (m, 1) of the face at lift 0, away from the cam axis.
    """

    pose: Pose
    normal: ComplexArray

    def require_reach(self, cam: CamPoints) -> None:
        """See `Rolling`: the curve, along which n = i sigma t, is bent inward everywhere."""
        if not np.all(dot(cam.spin * cam.along, cam.bend) < 0.0):
            raise GeometryError(HOLLOW)

    def step(self, cam: CamPoints, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Rolling`."""
        normal = self.normal * self.pose.turn_factor(q)
        turning = 1j * self.pose.spin * normal
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
    """How the followers (m, ...) of machines touch the cam; `pose` is that of the nominal one."""
    del pose, deviations  # used by the registered ones
    message = f'of the kind "{follower.kind}" is not known to the analysis of tolerances'
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
    held = pose.moved(deviations.amounts(Way.PIVOT), whole=True).moved(deviations.amounts(Way.BODY))
    return held.rotated(np.exp(1j * deviations.real(Way.TILT)))


@dataclass(frozen=True, slots=True, eq=False)
class MachineMotions:
    """The motions of m machines at n cam angles; derivatives per rad of the cam angle.

    Attributes
    ----------
    follower : (3, m, n) its lift [mm or rad], counted from the nominal zero, and two derivatives.
    position : (3, m, n) of the far end of a linkage, or of the follower if there is none.
    leverage : (m, n) magnitude of n . dW/dq [1 or mm/rad].
    zero : (m, 1) lift at the deviating base radius, from which the others are counted.
    """

    follower: FloatArray
    position: FloatArray
    leverage: FloatArray
    zero: FloatArray


def replay_machines(nominal: Sensitivities, deviations: Deviations) -> MachineMotions:
    """The motions of machines that deviate.

    Raises
    ------
    GeometryError
        If a machine has no contact near the nominal one, undercuts, or its linkage does not close.
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
    machine = nominal.machine
    follower = machine.cam.follower
    contact = follower_contact(follower, machine.pose, deviations)
    lifts, leverage = _follower(nominal, deviations, contact)
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
    """(3, m, n) lift and two derivatives, counted from the nominal zero; and the leverage."""
    machine, phi = nominal.machine, nominal.phi
    disc = machine.cam.disc
    curve = FlankCurve(disc.pitch_curve, deviations)
    spin = 1j * disc.rotation
    turn = np.exp(spin * (phi + deviations.real(Way.TIMING)))
    seat, axis = deviations.amounts(Way.SEAT), deviations.amounts(Way.SHAFT)
    shape = (deviations.count, len(phi))
    u = np.broadcast_to(phi, shape) + deviations.real(Way.TIMING)
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
        lost = ~(np.abs(u - phi) < FARTHEST)
        if np.any(lost):
            break
        last = max(float(np.max(np.abs(dq))), float(np.max(np.abs(du))) ** 2)
    excess = np.where(np.any(lost), lost, np.abs(dq))  # where nothing is lost it does not settle
    place = float(np.degrees(phi[int(np.argmax(np.max(excess, axis=0)))]))
    raise GeometryError(LOST.format(place))


def _setting(nominal: Contact, deviations: Deviations, follower: Follower) -> FloatArray:
    """(m, 1) lifts of the nominal follower at which the radii are the deviating base radii."""
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
    """Unit normals of a curve, to either side, and its pace."""
    pace = np.abs(along)
    return 1j * along / pace, pace


# -- flank curve ----------------------------------------------------------------------------------
# The curve on which machines touch the cam: the pitch curve, grown and waved.
#
# With the pitch curve Z(u), its unit tangent t and normal N = i sigma t, its pace v = |Z'| and its
# curvature kappa, P = Z + c N has
#
#     P'  = v (1 + c kappa) t + c' N,
#     P'' = (v' (1 + c kappa) + v c kappa' + 2 v c' kappa) t + (c'' - v^2 kappa (1 + c kappa)) N.


@dataclass(frozen=True, slots=True, eq=False)
class FlankCurve:
    """The curves of m machines.

    Attributes
    ----------
    pitch : the nominal one.
    deviations : of the machines.
    """

    pitch: PitchCurve
    deviations: Deviations

    def jet(self, u: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """(m, n) each: P [mm] and two derivatives at the parameters u (m, n) [rad].

        Raises
        ------
        GeometryError
            Where a roller that is too large, or waves, undercut.
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
        """c [mm] and two derivatives; None if there is none anywhere."""
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
