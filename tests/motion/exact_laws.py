"""All laws with far more digits than a double has, and errors in ulp.

A law is its lift f over z, piece by piece, for Taylor series: derivatives are those of the series.
From rest to rest f is as VDI 2143-1, section 6.1, prints it; for other tasks it is integrated from
the shape of f'', of which the guideline's formulas are the result. None of this is of use in double
precision, and camgeo's laws are written otherwise, so these are an independent reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Literal

from mpmath import mp, mpf

from tests.stability.series import Series, cosine, polynomial, sine, variable

Number = Any  # mpmath has no types
Values = tuple[Number, Number, Number, Number, Number]
Lift = Callable[[Series], Series]

DIGITS: Final = 120
"""z >= 1e-16 costs the formulas 64 digits at most, in 1 - f where f' to f''' vanish at z = 1, and
the amplitudes 36, where lambda and c are 1e-6."""

ZERO: Final = mpf(10) ** -70
"""Nothing that a law gives at z >= 1e-16 is smaller and not zero."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of a law: `lift` maps z to f."""

    start: Number
    end: Number
    lift: Lift


Pieces = tuple[Piece, ...]


# From rest to rest: halves of the symmetric laws, on [0, 1/2] ---------------------------------


def _modified_trapezoid() -> Pieces:
    """Eqs. (39), (42) and (45)."""
    pi, k = +mp.pi, mp.pi + 2
    return (
        Piece(mpf(0), mpf(1) / 8, lambda z: (2 * z - sine(4 * pi * z) / (2 * pi)) / k),
        Piece(
            mpf(1) / 8,
            mpf(3) / 8,
            lambda z: (4 * pi * z**2 + (2 - pi) * z + (pi**2 - 8) / (16 * pi)) / k,
        ),
        Piece(
            mpf(3) / 8,
            mpf(1) / 2,
            lambda z: (2 * (pi + 1) * z - sine(4 * pi * z - pi) / (2 * pi) - pi / 2) / k,
        ),
    )


def _modified_sine() -> Pieces:
    """Eqs. (57) and (60)."""
    pi, k = +mp.pi, mp.pi + 4
    return (
        Piece(mpf(0), mpf(1) / 8, lambda z: (pi * z - sine(4 * pi * z) / 4) / k),
        Piece(
            mpf(1) / 8,
            mpf(1) / 2,
            lambda z: (2 + pi * z - 9 * sine((4 * pi * z + pi) / 3) / 4) / k,
        ),
    )


ONE_FORMULA: Final[Mapping[str, Lift]] = {
    "straight-line": lambda z: z,
    "quadratic-parabola": lambda z: 2 * z**2,  # (24)
    "simple-sine": lambda z: (1 - cosine(mp.pi * z)) / 2,  # (30)
    "polynomial-345": lambda z: polynomial([0, 0, 0, 10, -15, 6], z),  # (33)
    "polynomial-4567": lambda z: polynomial([0, 0, 0, 0, 35, -84, 70, -20], z),
    "inclined-sine": lambda z: z - sine(2 * mp.pi * z) / (2 * mp.pi),  # (36)
}

HALVES: Final = (*ONE_FORMULA, "modified-trapezoid", "modified-sine")
"""The laws whose first half is printed; the 4-5-6-7 polynomial is not in the guideline."""


def _half(name: str) -> Pieces:
    """The accelerating half of a symmetric law."""
    if name in ONE_FORMULA:
        return (Piece(mpf(0), mpf(1) / 2, ONE_FORMULA[name]),)
    return _modified_trapezoid() if name == "modified-trapezoid" else _modified_sine()


def _stretched(law: Pieces, factor: Number) -> Pieces:
    def scaled(lift: Lift) -> Lift:
        return lambda z: factor * lift(z / factor)

    return tuple(
        Piece(factor * piece.start, factor * piece.end, scaled(piece.lift)) for piece in law
    )


def mirrored(law: Pieces) -> Pieces:
    """1 - f(1 - z)."""

    def image(lift: Lift) -> Lift:
        return lambda z: 1 - lift(1 - z)

    return tuple(Piece(1 - piece.end, 1 - piece.start, image(piece.lift)) for piece in law[::-1])


# Laws from the shapes of their accelerations --------------------------------------------------


Shape = Literal["rise", "fall", "level"]


@dataclass(frozen=True, slots=True)
class Pulse:
    """f'' over a stretch of that length: a quarter sine that rises to 1 or falls from it, or level.

    `part` is which of the two amplitudes it has, C_a (0) or C_a* (1); None where f'' = 0.
    """

    length: Number
    shape: Shape
    part: int | None


def _pulse_piece(pulse: Pulse, start: Number, amplitude: Number, f: Number, f1: Number) -> Piece:
    """The law over one pulse that begins at z = `start` with lift f and velocity f1."""
    k = mp.pi / (2 * pulse.length)
    own: Mapping[str, Lift] = {
        "rise": lambda u: (u - sine(k * u) / k) / k,
        "fall": lambda u: (1 - cosine(k * u)) / k**2,
        "level": lambda u: u**2 / 2,
    }

    def lift(z: Series) -> Series:
        u = z - start
        moved: Series = f + f1 * u + amplitude * own[pulse.shape](u)
        return moved

    return Piece(start, start + pulse.length, lift)


def _run(pulses: Iterable[Pulse], amplitudes: tuple[Number, Number], v0: Number) -> Pieces:
    """The law with these amplitudes, from f = 0 and f' = v0 at z = 0."""
    place, f, f1 = mpf(0), mpf(0), mpf(v0)
    run = []
    for pulse in pulses:
        if pulse.length > 0:
            amplitude = mpf(0) if pulse.part is None else amplitudes[pulse.part]
            run.append(_pulse_piece(pulse, place, amplitude, f, f1))
            place = run[-1].end
            f, f1 = run[-1].lift(variable(place, mpf(1), 2)).terms
    return tuple(run)


def integrated(pulses: list[Pulse], v0: Number, v1: Number) -> Pieces:
    """The law whose f'' has that shape and which meets f(0) = 0, f(1) = 1, f'(0) and f'(1)."""
    one, two = (
        _run(pulses, amplitudes, mpf(0))[-1].lift(variable(mpf(1), mpf(1), 2)).terms
        for amplitudes in ((mpf(1), mpf(0)), (mpf(0), mpf(1)))
    )
    matrix = mp.matrix([[one[0], two[0]], [one[1], two[1]]])
    ca, cb = mp.lu_solve(matrix, mp.matrix([1 - v0, v1 - v0]))
    return _run(pulses, (ca, cb), v0)


def _scca(p: Mapping[str, Number]) -> list[Pulse]:
    """Sine, constant, cosine (Norton): a quarter sine over the share b of the accelerating part, a
    constant, a quarter cosine over the share d; the decelerating part mirrored. Both parts take the
    share c of the way to the inflection point, f' is constant between them."""
    lam, curved, b, d = (p[key] for key in ("inflection", "curved", "sine", "cosine"))
    rise, fall, level = curved * lam, curved * (1 - lam), 1 - b - d
    return [
        Pulse(b * rise, "rise", 0),
        Pulse(level * rise, "level", 0),
        Pulse(d * rise, "fall", 0),
        Pulse(1 - curved, "level", None),
        Pulse(d * fall, "rise", 1),
        Pulse(level * fall, "level", 1),
        Pulse(b * fall, "fall", 1),
    ]


def _shape(name: str, p: Mapping[str, Number]) -> list[Pulse]:
    """The shape of f'' of a law with two amplitudes; of those that turn, from rest to turn."""
    lam = p["inflection"]
    m = 1 - lam
    if name == "scca":
        return _scca(p)
    rising: list[tuple[Number, Shape]]
    falling: list[tuple[Number, Shape]]
    if name == "modified-trapezoid":
        rising = [(lam / 4, "rise"), (lam / 2, "level"), (lam / 4, "fall")]
        falling = [(m / 4, "rise"), (3 * m / 4, "level")]
    elif name in ("modified-sine", "harmonic-combination"):
        rising = [(lam / 4, "rise"), (3 * lam / 4, "fall")]
        falling = (
            [(3 * m / 4, "rise"), (m / 4, "fall")] if name == "modified-sine" else [(m, "rise")]
        )
    else:  # sine-straight, and simple-sine, which it is at c = 1
        c = p["curved"]
        straight = Pulse(1 - c, "level", None)
        return [Pulse(c * lam, "fall", 0), straight, Pulse(c * m, "rise", 1)]
    return [Pulse(length, shape, 0) for length, shape in rising] + [
        Pulse(length, shape, 1) for length, shape in falling
    ]


# The law of a name and a task -----------------------------------------------------------------

BOUNDARY: Final = {
    "v0": (0, 1), "a0": (0, 2), "j0": (0, 3), "v1": (1, 1), "a1": (1, 2), "j1": (1, 3),
}  # fmt: skip
"""The place and the derivative that a boundary value is of."""


def _least_degree(values: Mapping[str, Number]) -> Pieces:
    """The polynomial of least degree with f(0) = 0, f(1) = 1 and these boundary values."""
    known = {(0, 0): mpf(0), (1, 0): mpf(1)} | {BOUNDARY[key]: v for key, v in values.items()}
    rows = [
        [mp.ff(power, order) * mpf(place) ** max(power - order, 0) for power in range(len(known))]
        for place, order in known
    ]
    solved = list(mp.lu_solve(mp.matrix(rows), mp.matrix(list(known.values()))))
    return (Piece(mpf(0), mpf(1), lambda z: polynomial(solved, z)),)


def _double_harmonic(z: Series) -> Series:
    """From rest to turn (Rothbart)."""
    f: Series = (1 - cosine(mp.pi * z)) / 2 - (1 - cosine(2 * mp.pi * z)) / 8
    return f


def exact_pieces(name: str, task: str, parameters: Mapping[str, Number]) -> Pieces:
    """The pieces of a law; parameters are exact, missing ones as `make_law` completes them."""
    return _exact_pieces(name, task, tuple(sorted(parameters.items())))


@cache
def _exact_pieces(name: str, task: str, parameters: tuple[tuple[str, Number], ...]) -> Pieces:
    with mp.workdps(DIGITS):
        own = {key: mpf(value) for key, value in parameters}
        p = dict.fromkeys(BOUNDARY, mpf(0)) | {"inflection": mpf("0.5"), "curved": mpf(1)} | own
        if name == "polynomial":
            return _least_degree(own)
        if name in ("polynomial-5", "polynomial-7"):
            met = "va" if name == "polynomial-5" else "vaj"
            return _least_degree({key: p[key] for key in BOUNDARY if key[0] in met})
        if name == "straight-line" or (task == "R-R" and name != "scca"):
            half, lam = _half(name), p["inflection"]
            return _stretched(half, 2 * lam) + mirrored(_stretched(half, 2 * (1 - lam)))
        if task[0] == "U" and task[-1] != "U":  # the mirror image, with f'(1) for f'(0)
            return mirrored(exact_pieces(name, task[::-1], own | {"v0": p["v1"], "v1": mpf(0)}))
        if name == "double-harmonic":
            return (Piece(mpf(0), mpf(1), _double_harmonic),)
        return integrated(_shape(name, p), p["v0"], p["v1"])


def piece_at(law: Pieces, z: Number) -> Piece:
    """The piece that holds at z, the right one at a border."""
    return next((piece for piece in law[::-1] if piece.start <= z), law[0])


def exact_lift(
    name: str, task: str, parameters: Mapping[str, Number], z: Series
) -> tuple[Series, Series]:
    """f and 1 - f of a series of z."""
    with mp.workdps(DIGITS):
        f = piece_at(exact_pieces(name, task, parameters), z.terms[0]).lift(z)
        return f, 1 - f


def values_of(piece: Piece, z: Number) -> Values:
    """f, 1 - f, f', f'', f''' of a piece at z, also outside the piece."""
    with mp.workdps(DIGITS):
        f = piece.lift(variable(mpf(z), mpf(1), 4))
        f1, f2, f3 = (f.derivative(order) for order in (1, 2, 3))
        return f.terms[0], 1 - f.terms[0], f1, f2, f3


def exact(name: str, task: str, parameters: Mapping[str, Number], z: Number) -> Values:
    """f, 1 - f, f', f'', f''' at z, the limits from the right."""
    return values_of(piece_at(exact_pieces(name, task, parameters), z), z)


# Errors ---------------------------------------------------------------------------------------


def ulps(value: float, true: Number) -> float:
    """Error of `value` in units in the last place of the true value; a true zero must be met."""
    with mp.workdps(DIGITS):
        if abs(true) < ZERO:
            return 0.0 if value == 0.0 else math.inf
        return float(abs(mpf(float(value)) - true) / mpf(math.ulp(float(true))))


def worst_ulps(values: Iterable[float], true: Iterable[Number]) -> float:
    """Largest of the errors in ulp."""
    return max(ulps(value, number) for value, number in zip(values, true, strict=True))


def decimal(text: str) -> Number:
    """A decimal string of the reference, with all its digits."""
    with mp.workdps(DIGITS):
        return mpf(text)
