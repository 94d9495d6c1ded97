"""Pulses of acceleration: the shape of one part of a law, from a border to the inflection point.

x runs from 0 at the border of the move to 1 at the inflection point, where the acceleration ends at
zero. Two pulses make a law, see below; all laws of VDI 2143-1 except the straight line and the
polynomials through boundary values consist of them.

With a(x) the acceleration, v and p its first and second integral from x = 0, and q(r) its second
integral backwards from the inflection point, r = 1 - x.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.law import Boundary, Law, Region, Values
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.extremes import derivative, horner, largest_magnitude, product, roots_inside

PI: Final = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")

DIGITS: Final = Context(prec=50)
"""Constants and amplitudes are computed with this many digits and rounded once."""


@dataclass(frozen=True, slots=True, eq=False)
class PulsePart:
    """A part of a pulse with one formula; laws with the same pulse share it.

    Attributes
    ----------
    start, end : in x, with 50 digits.
    formula : u (n,) -> (4, n) p, v, a, a', with u = x - start, or u = end - x if `from_end`.
    from_end : from which end u is counted: a value that vanishes at an end is exact to its last
        digits only if u is counted from there.
    back : r (n,) -> q (n,).
    jerk : largest |a'|.
    turns : b, s -> all x inside at which b + s v or one of its integral, a, a' and (b + s v) a may
        have an extremum; other values may be among them.
    continues : whether it is the same function as the preceding stretch, so that no derivative
        jumps between them.
    harmonic : rate k of a stretch with a' = -k^2 v, in which the position swings about a fixed
        middle; 0 for other stretches.
    """

    start: Decimal
    end: Decimal
    formula: Callable[[FloatArray], FloatArray]
    from_end: bool
    back: Callable[[FloatArray], FloatArray]
    jerk: float
    turns: Callable[[float, float], tuple[float, ...]]
    continues: bool = False
    harmonic: float = 0.0


@dataclass(frozen=True, slots=True)
class Pulse:
    """A pulse of acceleration of length 1.

    Attributes
    ----------
    stretches : from x = 0 to x = 1 without gaps.
    velocity, position : v(1), p(1), with 50 digits.
    border : a(0).
    end : a(1); where it is 0, a is an odd function of r.
    jerk : a'(0).
    peak : largest a.
    """

    stretches: tuple[PulsePart, ...]
    velocity: Decimal
    position: Decimal
    border: float
    end: float
    jerk: float
    peak: float = 1.0

    @property
    def ends_straight(self) -> bool:
        """Whether the pulse ends with a stretch without acceleration."""
        return self.stretches[-1].jerk == 0.0 and self.end == 0.0

    @classmethod
    def polynomial(cls, acceleration: tuple[int, ...]) -> Pulse:
        """A pulse whose acceleration is a polynomial with a(0) = 0, odd in r = 1 - x.

        Parameters
        ----------
        acceleration : its coefficients in ascending powers of x, whole numbers.
        """
        with localcontext(DIGITS):
            a_exact = [Decimal(c) for c in acceleration]
            v_exact = _integral(a_exact)
            p_exact = _integral(v_exact)
            exact = (p_exact, v_exact, a_exact, _derivative(a_exact))
            by_x = [[float(c) for c in coefficients] for coefficients in exact]
            by_r = [[float(c) for c in _reflected(coefficients)] for coefficients in exact]
            columns_of_x, columns_of_r = _columns(by_x), _columns(by_r)
            backwards = [float(c) for c in _integral(_integral(_reflected(a_exact)))]
            velocity, position = sum(v_exact, Decimal(0)), sum(p_exact, Decimal(0))
        _, v, a, j = by_x

        @functools.cache
        def turning_places() -> tuple[float, ...]:
            slopes = (j, derivative(j), derivative(product(v, a)))
            roots = np.concatenate([roots_inside(c, 0.0, 1.0) for c in slopes])
            return tuple(float(x) for x in ascending(roots))

        def turns(_base: float, _scale: float) -> tuple[float, ...]:
            return turning_places()

        def from_start(u: FloatArray) -> FloatArray:
            return horner(columns_of_x, u)

        def from_end(u: FloatArray) -> FloatArray:
            return horner(columns_of_r, u)

        def back(r: FloatArray) -> FloatArray:
            return horner(backwards, r)

        # Below it the form in x has more digits, above it the form in r; here both keep enough.
        middle = Decimal("0.7")
        largest = largest_magnitude(j, 0.0, 1.0)
        return cls(
            stretches=(
                PulsePart(Decimal(0), middle, from_start, False, back, largest, turns),
                PulsePart(middle, Decimal(1), from_end, True, back, largest, turns, continues=True),
            ),
            velocity=velocity,
            position=position,
            border=0.0,
            end=0.0,
            jerk=j[0],
            peak=largest_magnitude(a, 0.0, 1.0),
        )


@functools.lru_cache(maxsize=256)
def sine_pulse(sine: Decimal, constant: Decimal, cosine: Decimal) -> Pulse:
    """The SCCA pulse: a quarter of a sine, a constant, a quarter of a cosine, then no acceleration.

    Parameters
    ----------
    sine, constant, cosine : shares of the length; none is negative, and they add up to more than 0
        and at most 1. The remainder runs without acceleration.

    VDI 2143-1 gives it in eqs. (24) to (32), (36) to (65), (95) to (119), (151) to (192) and (207)
    to (218); R. L. Norton, Cam Design and Manufacturing Handbook, calls the family SCCA.
    """
    with localcontext(DIGITS):
        shares = _Shares(sine, constant, cosine, 1 - sine - constant - cosine)
        stretches: list[PulsePart] = []
        if sine:
            stretches.append(_sine_stretch(shares))
        if constant:
            stretches.append(_constant_stretch(shares))
        if cosine:
            stretches += _cosine_stretches(shares)
        if shares.still:
            stretches.append(_still_stretch(shares))
        velocity, position = shares.cosine_end
        return Pulse(
            stretches=tuple(stretches),
            velocity=velocity,
            position=position + velocity * shares.still,
            border=0.0 if sine else 1.0,
            end=0.0 if cosine or shares.still else 1.0,
            jerk=0.5 * math.pi / float(sine) if sine else 0.0,
        )


@dataclass(frozen=True, slots=True)
class _Shares:
    """Lengths of the four stretches, and velocity and position where they meet, with 50 digits."""

    sine: Decimal
    constant: Decimal
    cosine: Decimal
    still: Decimal

    @property
    def sine_end(self) -> tuple[Decimal, Decimal]:
        length = 2 * self.sine / PI
        return length, length**2 * (PI / 2 - 1)

    @property
    def constant_end(self) -> tuple[Decimal, Decimal]:
        v, p = self.sine_end
        return v + self.constant, p + v * self.constant + self.constant**2 / 2

    @property
    def cosine_end(self) -> tuple[Decimal, Decimal]:
        v, p = self.constant_end
        length = 2 * self.cosine / PI
        return v + length, p + v * self.cosine + length**2

    @property
    def cosine_start_backwards(self) -> tuple[Decimal, Decimal]:
        """q' and q where the cosine starts: the integrals of a backwards from the inflection point.

        They are what velocity and position still gain up to there, without the gain of the position
        by the velocity that is already reached.
        """
        length = 2 * self.cosine / PI
        return length, length**2 * (PI / 2 - 1)

    @property
    def constant_start_backwards(self) -> tuple[Decimal, Decimal]:
        """The same integrals backwards, q' and q, where the constant starts."""
        w, q = self.cosine_start_backwards
        return w + self.constant, q + w * self.constant + self.constant**2 / 2


def _sine_stretch(shares: _Shares) -> PulsePart:
    """a = sin(pi x/(2 b)) over [0, b]."""
    b = float(shares.sine)
    # Derivative of the angle by x, and its reciprocal: each integration by x multiplies by
    # `length`.
    rate, length = 0.5 * math.pi / b, 2.0 * b / math.pi
    tail = float(1 - shares.sine)
    w, q = (float(value) for value in shares.constant_start_backwards)

    def formula(u: FloatArray) -> FloatArray:
        angle = rate * u
        half = 0.5 * angle
        sine, cosine = np.sin(half), np.cos(half)
        # 1 - cos of the whole angle, without cancellation.
        twice = 2.0 * sine * sine
        return np.array((
            length * length * x_minus_sin(angle),
            length * twice,
            2.0 * sine * cosine,
            rate * (1.0 - twice),
        ))  # fmt: skip

    def back(r: FloatArray) -> FloatArray:
        # Seen backwards, a starts at 1 and falls like a cosine; w and q are the integrals up to its
        # start.
        y = r - tail
        half = np.sin(0.5 * rate * y)
        return q + w * y + 2.0 * length * length * half * half

    def turns(base: float, scale: float) -> tuple[float, ...]:
        # (base + s - s cos t) sin t, s = scale length: s + (base + s) cos t - 2 s cos^2 t = 0.
        s = scale * length
        # f' = base + s - s cos t = 0.
        cosines = (*_quadratic(-2.0 * s, base + s, s), *_quadratic(0.0, -s, base + s))
        return tuple(math.acos(c) / rate for c in cosines if 0.0 < c < 1.0)

    return PulsePart(Decimal(0), shares.sine, formula, False, back, rate, turns)


def _constant_stretch(shares: _Shares) -> PulsePart:
    """a = 1."""
    velocity, position = (float(value) for value in shares.sine_end)
    w, q = (float(value) for value in shares.cosine_start_backwards)
    tail = float(shares.still + shares.cosine)

    def formula(u: FloatArray) -> FloatArray:
        lift = position + u * (velocity + 0.5 * u)
        return np.array((lift, velocity + u, np.ones_like(u), np.zeros_like(u)))

    def back(r: FloatArray) -> FloatArray:
        y = r - tail
        return q + y * (w + 0.5 * y)

    def turns(base: float, scale: float) -> tuple[float, ...]:
        # (base + s v) a is straight; it and f' are zero at one place.
        places = _quadratic(0.0, scale, base + scale * velocity)
        return tuple(float(shares.sine) + u for u in places if 0.0 < u < float(shares.constant))

    return PulsePart(
        shares.sine,
        shares.sine + shares.constant,
        formula,
        from_end=False,
        back=back,
        jerk=0.0,
        turns=turns,
    )


def _cosine_stretches(shares: _Shares) -> tuple[PulsePart, PulsePart]:
    """a = cos(pi u/(2 d)) over a length d, in two halves, each counted from its own end.

    The first keeps the digits of v and p where they begin at zero, the second those of a at its
    zero; either needs no more than a sine and a cosine.
    """
    d = float(shares.cosine)
    rate, length = 0.5 * math.pi / d, 2.0 * d / math.pi
    still = float(shares.still)
    velocity, position = (float(value) for value in shares.constant_end)
    start = shares.sine + shares.constant
    middle, end = start + shares.cosine / 2, start + shares.cosine
    last = float(shares.constant_end[1] + shares.constant_end[0] * shares.cosine)

    def from_start(u: FloatArray) -> FloatArray:
        half = 0.5 * rate * u
        sine, cosine = np.sin(half), np.cos(half)
        double = 2.0 * sine * cosine
        # 1 - cos of the whole angle; `double` is its sine.
        square = 2.0 * sine * sine
        return np.array((
            position + velocity * u + length * length * square,
            velocity + length * double,
            1.0 - square,
            -rate * double,
        ))  # fmt: skip

    def from_end(u: FloatArray) -> FloatArray:
        half = 0.5 * rate * u
        sine, cosine = np.sin(half), np.cos(half)
        difference = cosine - sine
        turned = difference * (cosine + sine)  # sine of the angle from the start
        return np.array((
            last - velocity * u + length * length * difference * difference,
            velocity + length * turned,
            2.0 * sine * cosine,
            -rate * turned,
        ))  # fmt: skip

    def back(r: FloatArray) -> FloatArray:
        return length * length * x_minus_sin(rate * (r - still))

    def turns(base: float, scale: float) -> tuple[float, ...]:
        # (b + s sin t) cos t with b = base + scale v, s = scale length: s - b sin t - 2 s sin^2 t.
        s, b = scale * length, base + scale * velocity
        sines = (*_quadratic(-2.0 * s, -b, s), *_quadratic(0.0, s, b))  # and f' = b + s sin t
        return tuple(float(start) + math.asin(sine) / rate for sine in sines if 0.0 < sine < 1.0)

    one_sine = not shares.constant and shares.sine == shares.cosine
    harmonic = 0.0 if velocity else rate  # the whole velocity is the sine
    return (
        PulsePart(start, middle, from_start, False, back, rate, turns, one_sine, harmonic),
        PulsePart(middle, end, from_end, True, back, rate, turns, True, harmonic),
    )


def _still_stretch(shares: _Shares) -> PulsePart:
    """a = 0."""
    velocity, position = (float(value) for value in shares.cosine_end)

    def formula(u: FloatArray) -> FloatArray:
        zero = np.zeros_like(u)
        return np.array((position + velocity * u, np.full_like(u, velocity), zero, zero))

    return PulsePart(
        1 - shares.still,
        Decimal(1),
        formula,
        from_end=False,
        back=np.zeros_like,
        jerk=0.0,
        turns=lambda _base, _scale: (),
    )


def _columns(polynomials: list[list[float]]) -> FloatArray:
    """(k, m, 1) the coefficients of m polynomials, for `horner`."""
    return np.array([*itertools.zip_longest(*polynomials, fillvalue=0.0)])[:, :, np.newaxis]


def _quadratic(a: float, b: float, c: float) -> tuple[float, ...]:
    """Real roots of a t^2 + b t + c, without cancellation."""
    if a == 0.0:
        return (-c / b,) if b != 0.0 else ()
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return ()
    # b and the root have the same sign here, so nothing cancels; the other root follows from the
    # product of both, c/a.
    half = -0.5 * (b + math.copysign(math.sqrt(square), b))
    return (half / a,) if half == 0.0 else (half / a, c / half)


def _integral(coefficients: list[Decimal]) -> list[Decimal]:
    return [Decimal(0), *(c / power for power, c in enumerate(coefficients, start=1))]


def _derivative(coefficients: list[Decimal]) -> list[Decimal]:
    return [power * c for power, c in enumerate(coefficients)][1:]


def _reflected(coefficients: list[Decimal]) -> list[Decimal]:
    """Coefficients in r = 1 - x of a polynomial in x."""
    return [
        sum(((-1) ** k * math.comb(n, k) * c for n, c in enumerate(coefficients)), Decimal(0))
        for k in range(len(coefficients))
    ]


# -- trigonometry ---------------------------------------------------------------------------------
# Differences of trigonometric functions without cancellation.


# x - sin x = x^3/6 (1 - 6 x^2/5! + 6 x^4/7! - ...). Ten terms leave less than 1e-17 of the value
# up to x = pi/2.
COEFFICIENTS = tuple((-1) ** k * 6.0 / math.factorial(2 * k + 3) for k in range(10))


def x_minus_sin(x: FloatArray) -> FloatArray:
    """Return x - sin x for 0 <= x <= pi/2, to a few ulp of the result."""
    square = x * x
    series = COEFFICIENTS[-1] * square
    for coefficient in COEFFICIENTS[-2:0:-1]:
        series += coefficient
        series *= square
    series += 1.0
    square *= x
    square /= 6.0
    square *= series
    return square


# -- two pulses ------------------------------------------------------------------------------------
# Laws of two pulses: an accelerating part over [0, lambda], a decelerating one over [lambda, 1].
#
# Each part begins at its own border, the second one backwards: f = v0 z + A l1^2 p1(z/l1) from the
# start, 1 - f = v1 w + B l2^2 p2(w/l2) from the end, w = 1 - z, with l1 = lambda and l2 = 1 -
# lambda. A = C_a and B = -C_a* follow from f and f' being continuous at lambda (VDI 2143-1, eqs.
# (90), (91), (120), (121), (169), (171), (193), (195), (220), (221), all of them special cases):
#
#     V1 l1 A - V2 l2 B = v1 - v0          P1 l1^2 A + P2 l2^2 B = 1 - l1 v0 - l2 v1
#
# with V, P the velocity and the position at the end of a pulse. f'' is continuous at lambda,
# because each pulse ends at zero there.


HALF = Decimal("0.5")

STILL = 8
"""How many numbers the formula of a part needs whose border is at rest; a part with a velocity at
its border needs those after them, too."""


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
            # The determinant of the two linear equations for A l1 and B l2, see above.
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
            v1_p2 = self.first.velocity * self.second.position
            slope = self.second.velocity * self.first.position - v1_p2
            rise = self.first.velocity - self.first.position
            roots = _inside(
                -b * slope,
                b * (slope - v1_p2) - d * rise,
                b * v1_p2 - self.first.velocity * (1 - v1),
            )
            if not roots:
                raise self._unreachable_error(acceleration)
            return roots[0]

    def reach(self) -> tuple[float, bool]:
        """The bound of f''(1) over all lambda, and whether f''(1) lies above it, for a second pulse
        that starts at its peak.

        f''(1) runs from the bound, as lambda tends to 0, to infinity, as lambda tends to 1.
        """
        v0, v1 = Decimal(self.v0), Decimal(self.v1)
        # The sign of B near lambda = 1, where its magnitude grows beyond all bounds.
        grows = self.first.velocity * (1 - v0) - self.first.position * (v1 - v0)
        return -float((1 - v1) / self.second.position), grows <= 0

    def _unreachable_error(self, acceleration: float) -> GeometryError:
        """The error for an `acceleration` that no lambda gives; it states the possible ones."""
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
            # The largest acceleration of a part is its amplitude times the peak of its pulse.
            weight = Decimal(first.peak) / Decimal(second.peak)
            a0 = weight * (second.velocity * (1 - v1) + second.position * d)
            a1 = weight * d * (second.velocity - second.position)
            b0 = first.velocity * (1 - v1)
            b1 = d * (first.velocity - first.position)
            # Opposite signs first: one part accelerates and the other one decelerates.
            for sign in (1, -1):
                roots = _inside(-a1 - sign * b1, a1 - a0 - sign * b0, a0)
                if roots:
                    return roots[0]
        if v0 == v1 == 1:
            # A straight line: both are zero for every lambda.
            return HALF
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
    # Distances from the inflection point are based on the length that is exactly a double, or on
    # the shorter one if both or neither of them are, so that the mirror image is based on the same
    # one.
    exact = l1 == Decimal(lengths[0]), l2 == Decimal(lengths[1])
    first_sets_middle = l1 <= l2 if exact[0] == exact[1] else exact[0]
    middle = lengths[0] if first_sets_middle else 1.0 - lengths[1]
    first = _LawPart(
        parts.first, (l1, l2), float(a), parts.v0, speed, (lift, left), middle, first_sets_middle
    )
    second = _LawPart(
        parts.second,
        (l2, l1),
        float(b),
        parts.v1,
        speed,
        (left, lift),
        middle,
        not first_sets_middle,
    )
    regions = (*first.regions(from_end=False), *reversed(second.regions(from_end=True)))
    # At the inflection point no derivative jumps if one odd function runs through it, as a
    # symmetric law has, or if both parts end with a straight line.
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
            region.start
            for region, continued in zip(regions[1:], continues, strict=True)
            if not continued
        ),
        start=first.boundary(1.0),
        end=second.boundary(-1.0),
        inflection=middle,
        parameters=MappingProxyType(dict(parameters)),
    )


@dataclass(frozen=True, slots=True)
class _LawPart:
    """One part of a law, counted from its border: y = z or w, and the other of them.

    Attributes
    ----------
    lengths : normalised spans of this part and of the other one, with 50 digits.
    amplitude : A or B.
    base : f' at the border.
    speed : f' at the inflection point.
    reached : near value (f or g, whichever belongs to the part) at the inflection point, and what
        remains to 1 after it.
    middle : z of the inflection point.
    sets_middle : whether the inflection point is placed exactly by the length of this part, else by
        that of the other one.
    """

    pulse: Pulse
    lengths: tuple[Decimal, Decimal]
    amplitude: float
    base: float
    speed: float
    reached: tuple[float, float]
    middle: float
    sets_middle: bool

    def boundary(self, sign: float) -> Boundary:
        """f', f'', f''' at the border; `sign` is that of f''."""
        return Boundary(
            self.base,
            sign * self.amplitude * self.pulse.border + 0.0,  # not -0
            self.amplitude / float(self.lengths[0]) * self.pulse.jerk,
        )

    def regions(self, *, from_end: bool) -> list[Region]:
        """The regions, from the border to the inflection point."""
        parts = []
        for stretch in self.pulse.stretches:
            ends = [self._place(x, from_end=from_end) for x in (stretch.start, stretch.end)]
            parts.append(self._region(stretch, min(ends), max(ends), from_end=from_end))
        return parts

    def _place(self, x: Decimal, *, from_end: bool) -> float:
        """z of a place in the pulse."""
        if x == 1:
            return self.middle
        with localcontext(DIGITS):
            y = x * self.lengths[0]
            return float(1 - y if from_end else y)

    def _count(self, stretch: PulsePart, *, from_end: bool) -> tuple[float, float, float, float]:
        """The numbers `by_w`, `high`, `low` and `length` by which `_pulse_place` gives the u of a
        stretch.

        They say whether u is counted in w, from where (`high`, and in `low` what remains of the 50
        digits, so that u is exact to its last digits where it vanishes), and the length of u = 1,
        negative where u falls in that direction.
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
        """The same numbers for r, which is counted back from the inflection point.

        They use the length that places the inflection point exactly, see `sets_middle`.
        """
        length, other = (float(value) for value in self.lengths)
        if self.sets_middle:
            return float(from_end), length, 0.0, -length
        return float(not from_end), other, 0.0, length

    def _region(self, stretch: PulsePart, start: float, end: float, *, from_end: bool) -> Region:
        length, base = float(self.lengths[0]), self.base
        to_speed = self.amplitude * length
        to_lift = to_speed * length
        to_jerk = self.amplitude / length
        remainder = self.reached[1]
        # Where velocity at the border and acceleration have opposite signs, the lift is
        # counted from the inflection point: the two terms would cancel there.
        from_middle = stretch.from_end and base * self.amplitude < 0.0
        formula = _StretchFormula(stretch, moves=base != 0.0, from_middle=from_middle)
        numbers = np.array((
            *self._count(stretch, from_end=from_end),
            *(to_lift, to_speed, -self.amplitude if from_end else self.amplitude, to_jerk),
            *(float(from_end), base, self.reached[0], length, self.speed),
            *self._count_back(from_end=from_end),
        ))  # fmt: skip

        def far(z: FloatArray, w: FloatArray) -> FloatArray:
            near = formula(z, w, numbers)[0]
            return np.where(
                near < 0.5, 1.0 - near, remainder + formula.to_inflection(z, w, numbers)
            )

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
class _StretchFormula:
    """The formula of a stretch of a pulse in a law; its numbers give its place and speed.

    Attributes
    ----------
    moves : whether the law has a velocity at the border.
    from_middle : whether the lift is counted from the inflection point.
    """

    stretch: PulsePart
    moves: bool
    from_middle: bool

    def __call__(self, z: FloatArray, w: FloatArray, numbers: Any) -> Values:
        values = self.stretch.formula(_pulse_place(z, w, *numbers[:4]))
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
        """(n,) how much the near value still gains up to the inflection point."""
        length, speed = numbers[11:13]
        r = _pulse_place(z, w, *numbers[13:])
        return np.asarray(length * r * speed - numbers[4] * self.stretch.back(r))


def _pulse_place(
    z: FloatArray, w: FloatArray, by_w: Any, high: Any, low: Any, length: Any
) -> FloatArray:
    """(n,) u or r: distance from `high` + `low`, a place in z or, if `by_w`, in w, in units of
    `length`.

    `length` is negative if the distance is counted downwards. All four may be numbers, or arrays
    (n,) with one value for each place.
    """
    chosen = np.where(by_w, w, z) if np.ndim(by_w) else w if by_w else z
    place: FloatArray = chosen - high
    place -= low
    place /= length
    # A negative length makes -0 of 0, and adding 0 makes it 0 again.
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
