"""Laws of two pulses: an accelerating part over [0, lambda], a decelerating one over [lambda, 1].

Each part begins at its own border, the second one backwards: f = v0 z + A l1^2 p1(z/l1) from the
start, 1 - f = v1 w + B l2^2 p2(w/l2) from the end, w = 1 - z, with l1 = lambda and l2 = 1 - lambda.
A = C_a and B = -C_a* follow from f and f' being continuous at lambda (VDI 2143-1, eqs. (90), (91),
(120), (121), (169), (171), (193), (195), (220), (221), all of them special cases):

    V1 l1 A - V2 l2 B = v1 - v0          P1 l1^2 A + P2 l2^2 B = 1 - l1 v0 - l2 v1

with V, P the velocity and the position at the end of a pulse. f'' is continuous at lambda, because
each pulse ends at zero there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, localcontext
from types import MappingProxyType
from typing import Any

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.law import Boundary, Law, Region, Values
from camgeo.kinematics.laws.pulse import DIGITS, Pulse, Stretch
from camgeo.numeric.arrays import FloatArray

HALF = Decimal("0.5")

STILL = 8
"""Numbers of a part whose border is at rest; those of a velocity at the border follow them."""


@dataclass(frozen=True, slots=True)
class Parts:
    """The two parts of a law and its end velocities, before the inflection point is placed.

    Attributes
    ----------
    first, second : pulses of the accelerating and of the decelerating part.
    v0, v1 : f'(0), f'(1).
    """

    first: Pulse
    second: Pulse
    v0: float = 0.0
    v1: float = 0.0

    @property
    def mirrored(self) -> Parts:
        """The parts of the mirror image 1 - f(1 - z)."""
        return Parts(self.second, self.first, self.v1, self.v0)

    def amplitudes(self, inflection: Decimal) -> tuple[Decimal, Decimal]:
        """A = C_a and B = -C_a* for lambda = `inflection`, signed, with 50 digits."""
        with localcontext(DIGITS):
            l1, l2 = inflection, 1 - inflection
            v0, v1 = Decimal(self.v0), Decimal(self.v1)
            missing = 1 - l1 * v0 - l2 * v1
            first, second = self.first, self.second
            common = l2 * first.velocity * second.position + l1 * second.velocity * first.position
            a = second.velocity * missing + l2 * second.position * (v1 - v0)
            b = first.velocity * missing - l1 * first.position * (v1 - v0)
            return a / (l1 * common), b / (l2 * common)

    def inflection_for_start(self, acceleration: float) -> Decimal:
        """lambda with f''(0) = `acceleration`, for a first pulse that starts at its peak."""
        with localcontext(DIGITS):
            return 1 - self.mirrored.inflection_for_end(-acceleration)

    def inflection_for_end(self, acceleration: float) -> Decimal:
        """lambda with f''(1) = `acceleration`, for a second pulse that starts at its peak.

        VDI 2143-1, eqs. (179), (201), (206) and (206a), from one quadratic: with `acceleration`
        for -B, B l2 (l2 V1 P2 + l1 V2 P1) = V1 (1 - w) - l1 P1 D in l1.

        Raises
        ------
        GeometryError
            If there is no lambda in (0, 1); the message states which accelerations are possible.
        """
        with localcontext(DIGITS):
            b = -Decimal(acceleration)
            v0, v1 = Decimal(self.v0), Decimal(self.v1)
            d = v1 - v0
            own = self.first.velocity * self.second.position
            slope = self.second.velocity * self.first.position - own
            rise = self.first.velocity - self.first.position
            roots = _inside(
                -b * slope,
                b * (slope - own) - d * rise,
                b * own - self.first.velocity * (1 - v1),
            )
            if not roots:
                raise self._out_of_reach(acceleration)
            return roots[0]

    def reach(self) -> tuple[float, bool]:
        """The bound of f''(1), and whether f''(1) lies above it, for a second pulse that starts at
        its peak.

        f''(1) runs from the bound, at lambda = 0, to infinity, at 1.
        """
        v0, v1 = Decimal(self.v0), Decimal(self.v1)
        grows = self.first.velocity * (1 - v0) - self.first.position * (v1 - v0)
        return -float((1 - v1) / self.second.position), grows <= 0

    def _out_of_reach(self, acceleration: float) -> GeometryError:
        """The error for an acceleration that no lambda gives."""
        bound, above = self.reach()
        side = "above" if above else "below"
        return GeometryError(
            f"no inflection point gives the normalised acceleration {acceleration:.6g} at that"
            f" end; it must be {side} {bound:.6g}",
            key="acceleration",
            value=f"{acceleration:.6g}",
        )

    def inflection_for_equal_accelerations(self) -> Decimal:
        """lambda at which |C_a| = |C_a*|; preferably with C_a* = -C_a, else with C_a* = C_a.

        Raises
        ------
        GeometryError
            If there is none: the smaller of the two is least as lambda reaches 0 or 1.
        """
        with localcontext(DIGITS):
            v0, v1 = Decimal(self.v0), Decimal(self.v1)
            d = v1 - v0
            first, second = self.first, self.second
            # l2 (a0 + a1 l1) is A's numerator times l2, l1 (b0 + b1 l1) is B's times l1.
            weight = Decimal(first.peak) / Decimal(second.peak)
            a0 = weight * (second.velocity * (1 - v1) + second.position * d)
            a1 = weight * d * (second.velocity - second.position)
            b0 = first.velocity * (1 - v1)
            b1 = d * (first.velocity - first.position)
            for sign in (1, -1):
                roots = _inside(-a1 - sign * b1, a1 - a0 - sign * b0, a0)
                if roots:
                    return roots[0]
        if v0 == v1 == 1:
            return HALF  # a straight line: both are zero everywhere
        raise GeometryError(
            "no inflection point makes acceleration and deceleration equal for these end"
            f" velocities ({self.v0:g} and {self.v1:g}, normalised)",
            key="inflection",
        )


def law_of_two_pulses(
    name: str,
    task: str,
    parts: Parts,
    inflection: Decimal,
    parameters: Mapping[str, float],
) -> Law:
    """The law of two pulses with its inflection point at z = `inflection`, inside (0, 1).

    `parameters` are those that the law lists as its own.
    """
    a, b = parts.amplitudes(inflection)
    with localcontext(DIGITS):
        l1, l2 = inflection, 1 - inflection
        lift = float(Decimal(parts.v0) * l1 + a * l1**2 * parts.first.position)
        left = float(Decimal(parts.v1) * l2 + b * l2**2 * parts.second.position)
        speed = float(Decimal(parts.v0) + a * l1 * parts.first.velocity)
        symmetric = parts.first is parts.second and l1 == l2 and a == b
    lengths = float(l1), float(l2)
    # Distances from the inflection point are based on the length that is exactly a double,
    # or on the shorter one if both or neither are, so that the mirror image uses the same.
    exact = l1 == Decimal(lengths[0]), l2 == Decimal(lengths[1])
    kept = l1 <= l2 if exact[0] == exact[1] else exact[0]
    middle = lengths[0] if kept else 1.0 - lengths[1]
    first = _Part(parts.first, (l1, l2), float(a), parts.v0, speed, (lift, left), middle, kept)
    second = _Part(
        parts.second, (l2, l1), float(b), parts.v1, speed, (left, lift), middle, not kept
    )
    regions = (*first.regions(from_end=False), *reversed(second.regions(from_end=True)))
    # One formula runs through the middle, or a straight line.
    smooth = symmetric and parts.first.end == 0.0
    smooth |= parts.first.ends_straight and parts.second.ends_straight
    continues = (
        *(stretch.continues for stretch in parts.first.stretches[1:]),
        smooth,
        *(stretch.continues for stretch in reversed(parts.second.stretches[1:])),
    )
    return Law(
        name=name,
        task=task,
        regions=regions,
        borders=tuple(
            region.start for region, on in zip(regions[1:], continues, strict=True) if not on
        ),
        start=first.boundary(1.0),
        end=second.boundary(-1.0),
        inflection=middle,
        parameters=MappingProxyType(dict(parameters)),
    )


@dataclass(frozen=True, slots=True)
class _Part:
    """One part of a law, counted from its border: y = z or w, and the other of them.

    Attributes
    ----------
    lengths : of this part and of the other one, with 50 digits.
    amplitude : A or B.
    base : f' at the border.
    speed : f' at the inflection point.
    reached : near value (f or g of the part) at the inflection point, and what remains after it.
    middle : z of the inflection point.
    kept : whether the inflection point is placed exactly by the length of this part, else by that
        of the other.
    """

    pulse: Pulse
    lengths: tuple[Decimal, Decimal]
    amplitude: float
    base: float
    speed: float
    reached: tuple[float, float]
    middle: float
    kept: bool

    def boundary(self, sign: float) -> Boundary:
        """f', f'', f''' at the border; `sign` is that of f''."""
        return Boundary(
            self.base,
            sign * self.amplitude * self.pulse.border + 0.0,
            self.amplitude / float(self.lengths[0]) * self.pulse.jerk,
        )

    def regions(self, *, from_end: bool) -> list[Region]:
        """The regions, from the border to the inflection point."""
        found = []
        for stretch in self.pulse.stretches:
            ends = [self._place(x, from_end=from_end) for x in (stretch.start, stretch.end)]
            found.append(self._region(stretch, min(ends), max(ends), from_end=from_end))
        return found

    def _place(self, x: Decimal, *, from_end: bool) -> float:
        """z of a place in the pulse."""
        if x == 1:
            return self.middle
        with localcontext(DIGITS):
            y = x * self.lengths[0]
            return float(1 - y if from_end else y)

    def _count(self, stretch: Stretch, *, from_end: bool) -> tuple[float, float, float, float]:
        """The numbers of `_place_in` for the u of a stretch, exact to the last digits where u is 0.

        Whether u is counted in w, from where (with the rest of its 50 digits), and the length of u
        = 1, negative where u falls in that direction.
        """
        if stretch.from_end and stretch.end == 1:
            return self._count_back(from_end=from_end)
        length = float(self.lengths[0])
        with localcontext(DIGITS):
            zero = (stretch.end if stretch.from_end else stretch.start) * self.lengths[0]
            high = float(zero)
            low = float(zero - Decimal(high))
        return float(from_end), high, low, -length if stretch.from_end else length

    def _count_back(self, *, from_end: bool) -> tuple[float, float, float, float]:
        """The same for r, which is counted from the inflection point."""
        length, other = (float(value) for value in self.lengths)
        if self.kept:
            return float(from_end), length, 0.0, -length
        return float(not from_end), other, 0.0, length

    def _region(self, stretch: Stretch, start: float, end: float, *, from_end: bool) -> Region:
        length, base = float(self.lengths[0]), self.base
        to_speed = self.amplitude * length
        to_lift = to_speed * length
        to_jerk = self.amplitude / length
        far_at = self.reached[1]
        # Where velocity at the border and acceleration have opposite signs, the lift is
        # counted from the inflection point: the two terms would cancel there.
        from_middle = stretch.from_end and base * self.amplitude < 0.0
        formula = _Run(stretch, moves=base != 0.0, from_middle=from_middle)
        numbers = np.array((
            *self._count(stretch, from_end=from_end),
            *(to_lift, to_speed, -self.amplitude if from_end else self.amplitude, to_jerk),
            *(float(from_end), base, self.reached[0], length, self.speed),
            *self._count_back(from_end=from_end),
        ))  # fmt: skip

        def far(z: FloatArray, w: FloatArray) -> FloatArray:
            near = formula(z, w, numbers)[0]
            return np.where(near < 0.5, 1.0 - near, far_at + formula.to_inflection(z, w, numbers))

        def turns() -> tuple[float, ...]:
            ys = (length * x for x in stretch.turns(base, to_speed))
            return tuple(1.0 - y if from_end else y for y in ys)

        return Region(
            start=start,
            end=end,
            formula=formula,
            far=far,
            jerk_bound=abs(to_jerk) * stretch.jerk,
            from_end=from_end,
            numbers=tuple((numbers if base else numbers[:STILL]).tolist()),
            harmonic=0.0 if base else stretch.harmonic / length,
            turns=turns,
        )


@dataclass(frozen=True, slots=True)
class _Run:
    """The formula of a stretch of a pulse in a law; its numbers give its place and speed.

    Attributes
    ----------
    moves : whether the law has a velocity at the border.
    from_middle : whether the lift is counted from the inflection point.
    """

    stretch: Stretch
    moves: bool
    from_middle: bool

    def __call__(self, z: FloatArray, w: FloatArray, numbers: Any) -> Values:
        values = self.stretch.formula(_place_in(z, w, *numbers[:4]))
        values *= numbers[4:8].reshape(4, -1)
        if self.moves:
            from_end, base = numbers[8:10]
            values[1] += base
            if self.from_middle:
                values[0] = numbers[10] - self.to_inflection(z, w, numbers)
            else:
                values[0] += base * np.where(from_end, w, z)
        return values

    def to_inflection(self, z: FloatArray, w: FloatArray, numbers: Any) -> FloatArray:
        """The distance (n,) to the inflection point."""
        length, speed = numbers[11:13]
        r = _place_in(z, w, *numbers[13:])
        way: FloatArray = length * r * speed - numbers[4] * self.stretch.back(r)
        return way


def _place_in(
    z: FloatArray, w: FloatArray, by_w: Any, high: Any, low: Any, length: Any
) -> FloatArray:
    """(n,) the part of a pulse's length from `high` + `low` on, which are a z or, if `by_w`, a w.

    Not -0, which a negative length would make of 0.
    """
    chosen = np.where(by_w, w, z) if np.ndim(by_w) else w if by_w else z
    place: FloatArray = chosen - high
    place -= low
    place /= length
    place += 0.0
    return place


def _inside(a: Decimal, b: Decimal, c: Decimal) -> list[Decimal]:
    """Roots of a t^2 + b t + c inside (0, 1), the smaller first."""
    if a == 0:
        roots = [-c / b] if b != 0 else []
    else:
        square = b * b - 4 * a * c
        if square < 0:
            return []
        half = -(b + square.sqrt().copy_sign(b)) / 2
        roots = [half / a, c / half] if half != 0 else [Decimal(0)]
    return sorted(root for root in roots if 0 < root < 1)
