"""All laws with far more digits than a double has, and errors in ulp.

The formulas of the guideline (`tests.motion.printed`) are exact and, in double precision, useless
near the ends: the laws of camgeo are written otherwise, so the print is an independent oracle at
100 digits. What the guideline does not print is integrated from the shape of its acceleration.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Literal

from mpmath import mp, mpf

from tests.motion import printed
from tests.motion.printed import Exact, Formula, Number, Parameters, Piece, Pieces, mirrored

DIGITS = 100
"""z >= 1e-16 costs the formulas 64 digits at most, in 1 - f where f' to f''' vanish at z = 1."""

Values = tuple[Number, Number, Number, Number, Number]

ZERO = mpf(10) ** -70
"""Nothing that a law gives at z >= 1e-16 is smaller and not zero."""

BOUNDARY = {
    "v0": (0, 1), "a0": (0, 2), "j0": (0, 3), "v1": (1, 1), "a1": (1, 2), "j1": (1, 3),
}  # fmt: skip
"""The place and the derivative that a boundary value is of."""


# Laws from the shapes of their accelerations --------------------------------------------------


@dataclass(frozen=True, slots=True)
class Pulse:
    """f'' over a stretch of that length: a quarter sine that rises to 1 or falls from it, or level.

    `part` is which of the two amplitudes it has, C_a (0) or C_a* (1); None where f'' = 0.
    """

    length: Number
    shape: Literal["rise", "fall", "level"]
    part: int | None


def _stretch(pulse: Pulse, start: Number, amplitude: Number, f: Number, f1: Number) -> Piece:
    """The law over one pulse that begins at z = `start` with lift f and velocity f1."""
    k = mp.pi / (2 * pulse.length)

    def rise(z: Number) -> Exact:
        u = z - start
        return (
            f + f1 * u + amplitude / k * (u - mp.sin(k * u) / k),
            f1 + amplitude / k * (1 - mp.cos(k * u)),
            amplitude * mp.sin(k * u),
            amplitude * k * mp.cos(k * u),
        )

    def fall(z: Number) -> Exact:
        u = z - start
        return (
            f + f1 * u + amplitude / k**2 * (1 - mp.cos(k * u)),
            f1 + amplitude / k * mp.sin(k * u),
            amplitude * mp.cos(k * u),
            -amplitude * k * mp.sin(k * u),
        )

    def level(z: Number) -> Exact:
        u = z - start
        return f + f1 * u + amplitude * u**2 / 2, f1 + amplitude * u, amplitude, mpf(0)

    formula: Formula = {"rise": rise, "fall": fall, "level": level}[pulse.shape]
    return Piece(start, start + pulse.length, formula)


def _run(pulses: Iterable[Pulse], amplitudes: tuple[Number, Number], v0: Number) -> Pieces:
    """The law with these amplitudes, from f = 0 and f' = v0 at z = 0."""
    place, f, f1 = mpf(0), mpf(0), mpf(v0)
    run = []
    for pulse in pulses:
        if pulse.length <= 0:
            continue
        amplitude = mpf(0) if pulse.part is None else amplitudes[pulse.part]
        run.append(_stretch(pulse, place, amplitude, f, f1))
        place = run[-1].end
        f, f1, _, _ = run[-1].formula(place)
    return tuple(run)


def integrated(pulses: list[Pulse], v0: Number = 0, v1: Number = 0) -> Pieces:
    """The law whose f'' has that shape and which meets f(0) = 0, f(1) = 1, f'(0) and f'(1)."""
    one, two = (
        _run(pulses, amplitudes, mpf(0))[-1].formula(mpf(1))[:2]
        for amplitudes in ((mpf(1), mpf(0)), (mpf(0), mpf(1)))
    )
    matrix = mp.matrix([[one[0], two[0]], [one[1], two[1]]])
    ca, cb = mp.lu_solve(matrix, mp.matrix([1 - v0, v1 - v0]))
    return _run(pulses, (ca, cb), v0)


def scca(lam: Number, curved: Number, sine: Number, cosine: Number) -> list[Pulse]:
    """Sine, constant, cosine (Norton): a quarter sine over the share b of the accelerating part, a
    constant, a quarter cosine over the share d; the decelerating part mirrored. Both parts take the
    share c of the way to the inflection point, f' is constant between them."""
    rise, fall, level = curved * lam, curved * (1 - lam), 1 - sine - cosine
    return [
        Pulse(sine * rise, "rise", 0),
        Pulse(level * rise, "level", 0),
        Pulse(cosine * rise, "fall", 0),
        Pulse(1 - curved, "level", None),
        Pulse(cosine * fall, "rise", 1),
        Pulse(level * fall, "level", 1),
        Pulse(sine * fall, "fall", 1),
    ]


def shape_of(name: str, task: str, p: Parameters) -> list[Pulse]:
    """The shape of f'' of a law of the guideline whose print has two amplitudes."""
    lam = p["inflection"]
    m = 1 - lam
    quick = [Pulse(lam / 4, "rise", 0), Pulse(3 * lam / 4, "fall", 0)]
    if name == "modified-sine":
        return [*quick, Pulse(3 * m / 4, "rise", 1), Pulse(m / 4, "fall", 1)]
    if name == "harmonic-combination":
        return [*quick, Pulse(m, "rise", 1)]
    if name in ("sine-straight", "simple-sine"):
        c = p.get("curved", mpf(1))
        return [
            Pulse(c * lam, "fall", 0),
            Pulse(1 - c, "level", None),
            Pulse(c * m, "rise", 1),
        ]
    plateau = [Pulse(lam / 4, "rise", 0), Pulse(lam / 2, "level", 0), Pulse(lam / 4, "fall", 0)]
    if task == "R-U":
        return [*plateau, Pulse(m / 4, "rise", 1), Pulse(3 * m / 4, "level", 1)]
    return [*plateau, Pulse(m / 4, "rise", 1), Pulse(m / 2, "level", 1), Pulse(m / 4, "fall", 1)]


# The law of a name and a task -----------------------------------------------------------------


def exact_pieces(name: str, task: str, parameters: Mapping[str, float]) -> Pieces:
    """The pieces of a law; parameters as doubles, missing ones as `make_law` completes them."""
    return _exact_pieces(name, task, tuple(sorted(parameters.items())))


@cache
def _exact_pieces(name: str, task: str, parameters: tuple[tuple[str, float], ...]) -> Pieces:
    with mp.workdps(DIGITS):
        p = dict.fromkeys(BOUNDARY, mpf(0)) | {"inflection": mpf("0.5"), "curved": mpf(1)}
        p |= {key: mpf(value) for key, value in parameters}
        if name == "polynomial":
            given = {BOUNDARY[key]: p[key] for key, _ in parameters}
            return printed.least_degree(given)
        return _of_task(name, task, p)


def _of_task(name: str, task: str, p: Parameters) -> Pieces:
    lam = p["inflection"]
    if name == "polynomial-5":
        return printed.quintic(p["v0"], p["a0"], p["v1"], p["a1"])
    if name == "polynomial-7":
        return printed.least_degree({where: p[key] for key, where in BOUNDARY.items()})
    if name == "scca":
        return integrated(scca(lam, p["curved"], p["sine"], p["cosine"]))
    if task == "R-R" or name == "straight-line":
        return printed.shifted(printed.half(name), lam)
    if (name, task) in (("sine-straight", "U-U"), ("simple-sine", "U-U")):
        return printed.uu_sine_straight(lam, p["curved"])
    if name == "modified-sine":
        return printed.gg_modified_sine(lam, p["v0"], p["v1"])
    forward: dict[tuple[str, str], Callable[[], Pieces]] = {
        ("modified-trapezoid", "R-U"): lambda: printed.ru_trapezoid(lam),
        ("harmonic-combination", "R-U"): lambda: printed.ru_harmonic(lam),
        ("harmonic-combination", "G-U"): lambda: printed.gu_harmonic(lam, p["v0"]),
        ("double-harmonic", "R-U"): lambda: (Piece(mpf(0), mpf(1), printed.double_harmonic),),
    }
    if (name, task) in forward:
        return forward[name, task]()
    if (name, task[::-1]) not in forward:
        raise KeyError(f"no formula to judge {name} for {task} by")
    # U-R and U-G are the mirror images of R-U and G-U, with f'(1) for f'(0).
    return mirrored(_of_task(name, task[::-1], p | {"v0": p["v1"]}))


def piece_at(law: Pieces, z: Number) -> Piece:
    """The piece that holds at z, the right one at a border."""
    return next((piece for piece in law[::-1] if piece.start <= z), law[0])


def values_of(piece: Piece, z: Number) -> Values:
    """f, 1 - f, f', f'', f''' of the formula of a piece at z, also outside the piece."""
    with mp.workdps(DIGITS):
        f, f1, f2, f3 = piece.formula(mpf(z))
        return f, 1 - f, f1, f2, f3


def exact(name: str, task: str, parameters: Mapping[str, float], z: Number) -> Values:
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
