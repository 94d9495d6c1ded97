"""Pulses of acceleration: the shape of one part of a law, from a border to the inflection point.

x runs from 0 at the border of the move to 1 at the inflection point, where the acceleration ends at
zero. Two pulses make a law, see `camgeo.kinematics.laws.two_pulses`; all laws of VDI 2143-1 except
the straight line and the polynomials of given boundary values consist of them.

With a(x) the acceleration, v and p its first and second integral from x = 0, and q(r) its second
integral backwards from the inflection point, r = 1 - x.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.extremes import derivative, horner, largest_magnitude, product, roots_inside

PI: Final = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")

DIGITS: Final = Context(prec=50)
"""Constants and amplitudes are computed with this many digits and rounded once."""


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
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
    continues : whether the function of the preceding stretch continues in it.
    harmonic : rate k where a' = -k^2 v: the position swings about a fixed middle; 0 elsewhere.
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

    stretches: tuple[Stretch, ...]
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


@functools.lru_cache(maxsize=256)
def sine_pulse(sine: Decimal, constant: Decimal, cosine: Decimal) -> Pulse:
    """The SCCA pulse: a quarter of a sine, a constant, a quarter of a cosine, and then nothing.

    Parameters
    ----------
    sine, constant, cosine : shares of the length; none is negative, and they add up to more than 0
        and at most 1. The remainder runs without acceleration.

    VDI 2143-1 gives it in eqs. (24) to (32), (36) to (65), (95) to (119), (151) to (192) and (207)
    to (218); R. L. Norton, Cam Design and Manufacturing Handbook, calls the family SCCA.
    """
    with localcontext(DIGITS):
        shares = _Shares(sine, constant, cosine, 1 - sine - constant - cosine)
        stretches: list[Stretch] = []
        if sine:
            stretches.append(_sine_stretch(shares))
        if constant:
            stretches.append(_constant_stretch(shares))
        if cosine:
            stretches += _cosine_stretches(shares)
        if shares.still:
            stretches.append(_still_stretch(shares))
        velocity, position = shares.after_cosine
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
    def after_sine(self) -> tuple[Decimal, Decimal]:
        length = 2 * self.sine / PI
        return length, length**2 * (PI / 2 - 1)

    @property
    def after_constant(self) -> tuple[Decimal, Decimal]:
        v, p = self.after_sine
        return v + self.constant, p + v * self.constant + self.constant**2 / 2

    @property
    def after_cosine(self) -> tuple[Decimal, Decimal]:
        v, p = self.after_constant
        length = 2 * self.cosine / PI
        return v + length, p + v * self.cosine + length**2

    @property
    def before_cosine(self) -> tuple[Decimal, Decimal]:
        """Velocity and position still to come where the cosine starts, without its velocity.

        These are the integrals backwards, q and its derivative.
        """
        length = 2 * self.cosine / PI
        return length, length**2 * (PI / 2 - 1)

    @property
    def before_constant(self) -> tuple[Decimal, Decimal]:
        """As `before_cosine`, where the constant starts."""
        w, q = self.before_cosine
        return w + self.constant, q + w * self.constant + self.constant**2 / 2


def _sine_stretch(shares: _Shares) -> Stretch:
    """a = sin(pi x/(2 b)) over [0, b]."""
    b = float(shares.sine)
    rate, length = 0.5 * math.pi / b, 2.0 * b / math.pi
    tail = float(1 - shares.sine)
    w, q = (float(value) for value in shares.before_constant)

    def formula(u: FloatArray) -> FloatArray:
        angle = rate * u
        half = 0.5 * angle
        sine, cosine = np.sin(half), np.cos(half)
        twice = 2.0 * sine * sine
        return np.array((
            length * length * x_minus_sin(angle),
            length * twice,
            2.0 * sine * cosine,
            rate * (1.0 - twice),
        ))  # fmt: skip

    def back(r: FloatArray) -> FloatArray:
        # Backwards a falls like a cosine from 1.
        y = r - tail
        half = np.sin(0.5 * rate * y)
        return q + w * y + 2.0 * length * length * half * half

    def turns(base: float, scale: float) -> tuple[float, ...]:
        # (base + s - s cos t) sin t, s = scale length: s + (base + s) cos t - 2 s cos^2 t = 0.
        s = scale * length
        # f' = base + s - s cos t = 0.
        cosines = (*_quadratic(-2.0 * s, base + s, s), *_quadratic(0.0, -s, base + s))
        return tuple(math.acos(c) / rate for c in cosines if 0.0 < c < 1.0)

    return Stretch(Decimal(0), shares.sine, formula, False, back, rate, turns)


def _constant_stretch(shares: _Shares) -> Stretch:
    """a = 1."""
    velocity, position = (float(value) for value in shares.after_sine)
    w, q = (float(value) for value in shares.before_cosine)
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

    return Stretch(
        shares.sine,
        shares.sine + shares.constant,
        formula,
        from_end=False,
        back=back,
        jerk=0.0,
        turns=turns,
    )


def _cosine_stretches(shares: _Shares) -> tuple[Stretch, Stretch]:
    """a = cos(pi u/(2 d)) over a length d, in two halves, each counted from its own end.

    The first keeps the digits of v and p where they begin at zero, the second those of a at its
    zero; either needs no more than a sine and a cosine.
    """
    d = float(shares.cosine)
    rate, length = 0.5 * math.pi / d, 2.0 * d / math.pi
    still = float(shares.still)
    velocity, position = (float(value) for value in shares.after_constant)
    start = shares.sine + shares.constant
    middle, end = start + shares.cosine / 2, start + shares.cosine
    last = float(shares.after_constant[1] + shares.after_constant[0] * shares.cosine)

    def from_start(u: FloatArray) -> FloatArray:
        half = 0.5 * rate * u
        sine, cosine = np.sin(half), np.cos(half)
        double = 2.0 * sine * cosine
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
        Stretch(start, middle, from_start, False, back, rate, turns, one_sine, harmonic),
        Stretch(middle, end, from_end, True, back, rate, turns, True, harmonic),
    )


def _still_stretch(shares: _Shares) -> Stretch:
    """a = 0."""
    velocity, position = (float(value) for value in shares.after_cosine)

    def formula(u: FloatArray) -> FloatArray:
        zero = np.zeros_like(u)
        return np.array((position + velocity * u, np.full_like(u, velocity), zero, zero))

    return Stretch(
        1 - shares.still,
        Decimal(1),
        formula,
        from_end=False,
        back=np.zeros_like,
        jerk=0.0,
        turns=lambda _base, _scale: (),
    )


def polynomial_pulse(acceleration: tuple[int, ...]) -> Pulse:
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
    def found() -> tuple[float, ...]:
        slopes = (j, derivative(j), derivative(product(v, a)))
        roots = np.concatenate([roots_inside(c, 0.0, 1.0) for c in slopes])
        return tuple(float(x) for x in ascending(roots))

    def turns(_base: float, _scale: float) -> tuple[float, ...]:
        return found()

    def from_start(u: FloatArray) -> FloatArray:
        return horner(columns_of_x, u)

    def from_end(u: FloatArray) -> FloatArray:
        return horner(columns_of_r, u)

    def back(r: FloatArray) -> FloatArray:
        return horner(backwards, r)

    middle, largest = Decimal("0.7"), largest_magnitude(j, 0.0, 1.0)  # both forms keep digits there
    return Pulse(
        stretches=(
            Stretch(Decimal(0), middle, from_start, False, back, largest, turns),
            Stretch(middle, Decimal(1), from_end, True, back, largest, turns, continues=True),
        ),
        velocity=velocity,
        position=position,
        border=0.0,
        end=0.0,
        jerk=j[0],
        peak=largest_magnitude(a, 0.0, 1.0),
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
