"""Mechanisms as constraint equations, closed by Newton: nothing here knows a formula of camgeo.

A chain is its rigid lengths and paths. Its unknowns are coordinates of joints [mm] in the fixed
frame with the origin in the cam axis. What is zero where it closes are lengths [mm] too, and
polynomials of the unknowns, so that a complex step gives the Jacobian exactly, in doubles as in
40 digits.

Another mechanism is one more class: `guess` and `at_start` assemble it at lift 0, `gaps` hold it
closed for a demanded lift, `roller` gives the roller centre. A flat face is given by two points of
it, the rollers of two chains.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from mpmath import mp, mpc, mpf

from camgeo.numeric.arrays import FloatArray

Number = Any
"""A float, a complex number, or one of mpmath: what is done to it is +, -, *, / alone."""

Vector = Sequence[Number]
Equations = Callable[[Vector], list[Number]]

DIGITS = 40
STEP = 1e-30
"""Imaginary step: its square is far below the digits of either arithmetic."""

CLOSED = 1e-13
"""A chain whose next step is this share of its size is closed, in doubles."""


class Chain(Protocol):
    """A follower, with what stands in front of it, on a given cam axis."""

    @property
    def size(self) -> float:
        """Its largest length [mm]."""

    def guess(self) -> list[float]:
        """Unknowns about where they are at lift 0, on the right side of each dead centre."""

    def at_start(self, x: Vector) -> list[Number]:
        """Zero for the chain as it is assembled at lift 0."""

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        """Zero for the chain at the lift `demand` [mm or rad], if `start` solves `at_start`."""

    def roller(self, x: Vector) -> tuple[Number, Number]:
        """Coordinates of the roller centre, or of a point fixed to the follower [mm]."""


def circle(x: Number, y: Number, radius: float) -> Number:
    """How far (x, y) is from a circle about the origin [mm], polynomial."""
    return (x * x + y * y - radius * radius) / (2 * radius)


def versor(angle: Number) -> tuple[Number, Number]:
    """Cosine and sine."""
    if isinstance(angle, mpf | mpc):
        return mp.cos(angle), mp.sin(angle)
    return cmath.cos(angle), cmath.sin(angle)


def turned(x: Number, y: Number, angle: Number) -> tuple[Number, Number]:
    cosine, sine = versor(angle)
    return cosine * x - sine * y, sine * x + cosine * y


@dataclass(frozen=True)
class TranslatingChain:
    """Roller centre on a straight guide. Unknowns: its x, y."""

    base_radius: float
    offset: float
    guide_angle: float
    direction: int

    @property
    def size(self) -> float:
        return self.base_radius

    def guess(self) -> list[float]:
        along = cmath.rect(self.base_radius, self.guide_angle)
        return [along.real, along.imag]

    def _off_the_guide(self, x: Vector) -> Number:
        cosine, sine = versor(mpf(self.guide_angle))
        return x[0] * sine - x[1] * cosine - self.offset

    def at_start(self, x: Vector) -> list[Number]:
        return [self._off_the_guide(x), circle(x[0], x[1], self.base_radius)]

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        cosine, sine = versor(mpf(self.guide_angle))
        way = (x[0] - start[0]) * cosine + (x[1] - start[1]) * sine
        return [self._off_the_guide(x), way - self.direction * demand]

    def roller(self, x: Vector) -> tuple[Number, Number]:
        return x[0], x[1]


@dataclass(frozen=True)
class Rocker:
    """A pivot and an arm: what the chains that end in a rocker share."""

    pivot: complex
    arm: float
    base_radius: float
    arm_side: int

    @property
    def size(self) -> float:
        return abs(self.pivot) + self.arm

    def guess(self) -> list[float]:
        towards = -self.pivot / abs(self.pivot)
        tip = self.pivot + towards * cmath.rect(self.arm, self.arm_side * 1.0)
        return [tip.real, tip.imag]

    def seen(self, x: Number, y: Number) -> tuple[Number, Number]:
        """From the pivot."""
        return x - self.pivot.real, y - self.pivot.imag

    def at_start(self, x: Vector) -> list[Number]:
        return [circle(*self.seen(x[0], x[1]), self.arm), circle(x[0], x[1], self.base_radius)]

    def carried(self, x: Vector, start: Vector, crank: float) -> list[Number]:
        """Zero if arm and crank are one body: (tip of the arm)/(tip of the crank, x[4] and x[5])
        stays as at the start.
        """
        first, second = self.seen(start[0], start[1])
        square = crank * crank
        real = (first * start[4] + second * start[5]) / square
        imag = (second * start[4] - first * start[5]) / square
        now = self.seen(x[0], x[1])
        return [
            now[0] - (real * x[4] - imag * x[5]),
            now[1] - (imag * x[4] + real * x[5]),
        ]


@dataclass(frozen=True)
class OscillatingChain:
    """Roller centre on a rocker, whose angle is demanded. Unknowns: its x, y.

    A positive `direction` demands what takes the roller away from the cam axis at lift 0.
    """

    rocker: Rocker
    direction: int

    @property
    def size(self) -> float:
        return self.rocker.size

    def guess(self) -> list[float]:
        return self.rocker.guess()

    def at_start(self, x: Vector) -> list[Number]:
        return self.rocker.at_start(x)

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        first, second = self.rocker.seen(start[0], start[1])
        # The tip moves by i (tip - pivot) for a small angle; outward if that has a part along tip.
        outward = -second * start[0] + first * start[1]
        sense = self.direction if outward > 0 else -self.direction
        along, across = turned(first, second, sense * demand)
        now = self.rocker.seen(x[0], x[1])
        # Square to the demanded direction nothing, and the rigid length: two places, one nearby.
        square = (along * now[1] - across * now[0]) / self.rocker.arm
        return [square, circle(*now, self.rocker.arm)]

    def roller(self, x: Vector) -> tuple[Number, Number]:
        return x[0], x[1]


@dataclass(frozen=True)
class SliderCrankChain:
    """A slider that drives the rocker. Unknowns: x, y of roller, pin, crank's tip.

    Pin and tip are seen from the rocker's pivot.

    Attributes
    ----------
    rocker : with the roller.
    crank, coupler : rigid lengths [mm].
    pin : where the slider's pin is at stroke 0.
    sense : +1 if a positive stroke moves the slider to the right, -1 to the left.
    tip_side : +1 if at stroke 0 the tip lies counter-clockwise of the pin, seen from the pivot.
    """

    rocker: Rocker
    crank: float
    coupler: float
    pin: complex
    sense: int
    tip_side: int

    @property
    def size(self) -> float:
        return max(self.rocker.size, self.crank + self.coupler, abs(self.pin))

    def guess(self) -> list[float]:
        tip = self.pin / abs(self.pin) * cmath.rect(self.crank, self.tip_side * 1.0)
        return [*self.rocker.guess(), self.pin.real, self.pin.imag, tip.real, tip.imag]

    def _rods(self, x: Vector) -> list[Number]:
        return [
            circle(x[4], x[5], self.crank),
            circle(x[4] - x[2], x[5] - x[3], self.coupler),
            x[3] - self.pin.imag,
        ]

    def at_start(self, x: Vector) -> list[Number]:
        return [*self.rocker.at_start(x), *self._rods(x), x[2] - self.pin.real]

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        return [
            *self.rocker.carried(x, start, self.crank),
            *self._rods(x),
            x[2] - start[2] - self.sense * demand,
        ]

    def roller(self, x: Vector) -> tuple[Number, Number]:
        return x[0], x[1]


@dataclass(frozen=True)
class FourBarChain:
    """A lever on a shaft of its own that drives the rocker. Unknowns as of `SliderCrankChain`.

    Attributes
    ----------
    rocker : with the roller.
    crank, coupler, lever : rigid lengths [mm].
    shaft : of the lever, seen from the rocker's pivot.
    pin : where the lever's pin is at motion 0, seen from there too.
    sense : +1 if a positive motion turns the lever counter-clockwise, -1 clockwise.
    tip_side : as of `SliderCrankChain`.
    """

    rocker: Rocker
    crank: float
    coupler: float
    lever: float
    shaft: complex
    pin: complex
    sense: int
    tip_side: int

    @property
    def size(self) -> float:
        return max(self.rocker.size, self.crank + self.coupler, abs(self.shaft) + self.lever)

    def guess(self) -> list[float]:
        tip = self.pin / abs(self.pin) * cmath.rect(self.crank, self.tip_side * 1.0)
        return [*self.rocker.guess(), self.pin.real, self.pin.imag, tip.real, tip.imag]

    def _rods(self, x: Vector) -> list[Number]:
        return [
            circle(x[4], x[5], self.crank),
            circle(x[4] - x[2], x[5] - x[3], self.coupler),
            circle(x[2] - self.shaft.real, x[3] - self.shaft.imag, self.lever),
        ]

    def at_start(self, x: Vector) -> list[Number]:
        # Square to the lever as it is stated; its length is one of the rods.
        lever = self.pin - self.shaft
        across = lever.real * (x[3] - self.pin.imag) - lever.imag * (x[2] - self.pin.real)
        return [*self.rocker.at_start(x), *self._rods(x), across / self.lever]

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        first, second = start[2] - self.shaft.real, start[3] - self.shaft.imag
        along, across = turned(first, second, self.sense * demand)
        now = x[2] - self.shaft.real, x[3] - self.shaft.imag
        square = (along * now[1] - across * now[0]) / self.lever
        return [*self.rocker.carried(x, start, self.crank), *self._rods(x), square]

    def roller(self, x: Vector) -> tuple[Number, Number]:
        return x[0], x[1]


@dataclass(frozen=True)
class CarriageChain:
    """A crank that drives the carriage of the roller. Unknowns: x, y of roller; x of the slider's
    pin; x, y of the crank's tip. Pin and tip are seen from the crank's shaft.

    Attributes
    ----------
    guide : with the roller.
    crank, coupler : rigid lengths [mm].
    pin : where the slider's pin is at stroke 0.
    sense : +1 if a positive stroke moves the slider to the right, -1 to the left.
    tip : where the crank's tip is at stroke 0, about.
    """

    guide: TranslatingChain
    crank: float
    coupler: float
    pin: complex
    sense: int
    tip: complex

    @property
    def size(self) -> float:
        return self.guide.size + self.crank + max(self.coupler, self.crank)

    def guess(self) -> list[float]:
        return [*self.guide.guess(), self.pin.real, self.tip.real, self.tip.imag]

    def _rods(self, x: Vector) -> list[Number]:
        return [
            circle(x[3], x[4], self.crank),
            circle(x[3] - x[2], x[4] - self.pin.imag, self.coupler),
        ]

    def at_start(self, x: Vector) -> list[Number]:
        return [*self.guide.at_start(x), *self._rods(x), x[2] - self.pin.real]

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        along, across = turned(start[3], start[4], demand)
        square = (along * x[4] - across * x[3]) / self.crank
        stroke = self.sense * (x[2] - start[2])
        return [*self.guide.gaps(x, start, stroke), *self._rods(x), square]

    def roller(self, x: Vector) -> tuple[Number, Number]:
        return x[0], x[1]


@dataclass(frozen=True)
class Beside:
    """Another point of what carries the roller of a chain: a return roller, a point of a face.

    Attributes
    ----------
    chain : that closes; its unknowns are those of this one.
    pivot : about which the body turns, its roller being on an arm; None if it slides.
    place : from the roller, or as a multiple of the arm from the pivot, complex.
    """

    chain: Chain
    pivot: complex | None
    place: complex

    @property
    def size(self) -> float:
        far = abs(self.place) if self.pivot is None else abs(self.place) * self.chain.size
        return self.chain.size + far

    def guess(self) -> list[float]:
        return self.chain.guess()

    def at_start(self, x: Vector) -> list[Number]:
        return self.chain.at_start(x)

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        return self.chain.gaps(x, start, demand)

    def roller(self, x: Vector) -> tuple[Number, Number]:
        first, second = self.chain.roller(x)
        if self.pivot is None:
            return first + self.place.real, second + self.place.imag
        seen = first - self.pivot.real, second - self.pivot.imag
        return (
            self.pivot.real + self.place.real * seen[0] - self.place.imag * seen[1],
            self.pivot.imag + self.place.imag * seen[0] + self.place.real * seen[1],
        )


@dataclass(frozen=True)
class FaceChain:
    """A rocker with a flat face. Unknowns: x, y of the point at `arm` from the pivot along it.

    Along a parallel to the face, that is, which lies `offset` nearer to the cam axis than the face.

    Attributes
    ----------
    pivot : seen from the cam axis.
    arm : any length [mm].
    offset : how far the face lies beyond that parallel, away from the cam axis [mm].
    base_radius : of the face at lift 0.
    side : +1 if the face lies counter-clockwise of the line pivot to cam axis, -1 clockwise.
    sense : +1 if a positive lift turns it counter-clockwise, -1 clockwise.
    """

    pivot: complex
    arm: float
    offset: float
    base_radius: float
    side: int
    sense: int

    @property
    def size(self) -> float:
        return abs(self.pivot) + self.arm + abs(self.offset)

    def _seen(self, x: Vector) -> tuple[Number, Number]:
        return x[0] - self.pivot.real, x[1] - self.pivot.imag

    def guess(self) -> list[float]:
        tip = self.pivot - self.pivot / abs(self.pivot) * self.arm
        return [tip.real, tip.imag]

    def at_start(self, x: Vector) -> list[Number]:
        first, second = self._seen(x)
        # The pivot along the normal, which is the arm a quarter turn on: the cam axis at 0.
        height = self.side * (first * self.pivot.imag - second * self.pivot.real) / self.arm
        return [height + self.offset - self.base_radius, circle(first, second, self.arm)]

    def gaps(self, x: Vector, start: Vector, demand: Number) -> list[Number]:
        along, across = turned(*self._seen(start), self.sense * demand)
        now = self._seen(x)
        square = (along * now[1] - across * now[0]) / self.arm
        return [square, circle(*now, self.arm)]

    def roller(self, x: Vector) -> tuple[Number, Number]:
        return x[0], x[1]


# Newton -------------------------------------------------------------------------------------------


def jacobian(equations: Equations, x: Vector, unit: Number) -> list[list[Number]]:
    """Rows of derivatives by a complex step; `unit` is the imaginary unit of the arithmetic."""
    columns = []
    for index in range(len(x)):
        moved = list(x)
        moved[index] = moved[index] + unit * STEP
        columns.append([value.imag / STEP for value in equations(moved)])
    return [list(row) for row in zip(*columns, strict=True)]


def newton_in_doubles(
    equations: Equations, x: FloatArray, size: float
) -> tuple[FloatArray, float] | None:
    """Unknowns and the sign of the Jacobian's determinant; None if Newton wanders off."""
    for _ in range(30):
        values = np.array([complex(value).real for value in equations(list(map(float, x)))])
        matrix = np.array(
            [
                [float(entry) for entry in row]
                for row in jacobian(equations, list(map(float, x)), 1j)
            ]
        )
        step = np.linalg.solve(matrix, values)
        x = x - step
        if np.max(np.abs(step)) <= CLOSED * size:
            return x, float(np.sign(np.linalg.det(matrix)))
    return None


def newton_in_digits(equations: Equations, x: FloatArray | Vector) -> tuple[list[mpf], Any]:
    """Unknowns and the inverse of the Jacobian, to 40 digits, from what is good to a double."""
    found = [mpf(value) for value in x]
    for _ in range(3):
        inverse = mp.matrix(jacobian(equations, found, mpc(0, 1))) ** -1
        step = inverse * mp.matrix([value.real for value in equations(found)])
        found = [value - change for value, change in zip(found, step, strict=True)]
    return found, inverse


@dataclass(frozen=True)
class Closed:
    """A closed chain at one cam angle, to 40 digits.

    Attributes
    ----------
    roller : B [mm], fixed frame.
    rate : dB/d(lift).
    stiffness : largest way of an unknown for gaps of 1 mm: how far wrong lengths move the roller.
    """

    roller: mpc
    rate: mpc
    stiffness: float


def close(chain: Chain, lifts: FloatArray, wanted: list[int]) -> list[Closed]:
    """The chain at some of the `lifts` (n,), which it runs through one after the other from lift 0.

    The branch is that of the assembly: from one lift to the next Newton starts where it was, and
    the determinant keeps its sign, as a chain that passes no dead centre does. Where either fails
    the way is halved.
    """
    with mp.workdps(DIGITS):
        assembled = newton_in_doubles(chain.at_start, np.array(chain.guess()), chain.size)
        assert assembled is not None
        start, _ = newton_in_digits(chain.at_start, assembled[0])
        rough = [float(value) for value in start]
        first = newton_in_doubles(lambda x: chain.gaps(x, rough, 0.0), np.array(rough), chain.size)
        assert first is not None
        now, sign = first
        found, before = [], 0.0
        for number, lift in enumerate(lifts):
            now = _follow(chain, rough, now, sign, (before, float(lift)), 12)
            before = float(lift)
            if number in wanted:
                found.append(_exact(chain, start, now, before))
    return found


def _follow(
    chain: Chain,
    start: list[float],
    x: FloatArray,
    sign: float,
    way: tuple[float, float],
    halvings: int,
) -> FloatArray:
    result = newton_in_doubles(lambda y: chain.gaps(y, start, way[1]), x, chain.size)
    near = result is not None and np.max(np.abs(result[0] - x)) < 0.1 * chain.size
    if result is not None and near and result[1] == sign:
        return result[0]
    assert halvings, "the chain does not close"
    middle = 0.5 * (way[0] + way[1])
    x = _follow(chain, start, x, sign, (way[0], middle), halvings - 1)
    return _follow(chain, start, x, sign, (middle, way[1]), halvings - 1)


def _exact(chain: Chain, start: Vector, x: FloatArray, lift: float) -> Closed:
    demand = mpf(lift)
    found, inverse = newton_in_digits(lambda y: chain.gaps(y, start, demand), x)
    per_lift = [value.imag / STEP for value in chain.gaps(found, start, demand + mpc(0, 1) * STEP)]
    rates = -inverse * mp.matrix(per_lift)
    ahead = [value + mpc(0, 1) * STEP * rate for value, rate in zip(found, rates, strict=True)]
    moved = [value.imag / STEP for value in chain.roller(ahead)]
    stiffness = float(mp.mnorm(inverse, mp.inf))
    return Closed(mpc(*chain.roller(found)), mpc(*moved), stiffness)
