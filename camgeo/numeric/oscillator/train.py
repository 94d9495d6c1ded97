"""Elastic trains, decomposed into their modes.

The base moves by y(t), the masses by x_i; e_i = x_i - y is the deflection. With a = -y'' each mode
obeys u' = lambda u + a, see `camgeo.numeric.oscillator.mode`, and the deflection of the output is
e = Re sum c u over the modes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, frozen

EPS: Final = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False)
class Train:
    """The modes of an elastic train.

    Attributes
    ----------
    rates : (m,) lambda [1/s], Im lambda >= 0; one of each conjugate pair represents both; the
        slowest first.
    weights : (m,) c [s]. Re sum c = 0, Re sum c lambda = 1: a jump of y' does not move the masses.
    spread : factor by which the modes magnify rounding, at least 1.
    """

    rates: ComplexArray
    weights: ComplexArray
    spread: float = 1.0

    def transfer(self, frequency: float) -> complex:
        """Deflection by -y'' if y is a harmonic of that circular `frequency` [rad/s].

        At the frequency of an undamped mode it is as large as one rounding away from it.
        """
        s = 1j * frequency
        apart = s - self.rates
        near = np.abs(apart) < EPS * np.abs(self.rates)
        apart = np.where(near, EPS * np.abs(self.rates), apart)
        others = self.weights.conj() / (s - self.rates.conj())
        return complex(0.5 * np.sum(self.weights / apart + others))

    def sums(self, power: int) -> float:
        """Re sum c lambda^power."""
        return float(np.sum((self.weights * self.rates**power).real))


def one_mass(frequency: float, damping: float) -> Train:
    """x'' + 2 D w x' + w^2 x = 2 D w y' + w^2 y, with w = `frequency` [rad/s], 0 <= D < 1.

    A mass on a spring and a damper, both on the moving base (Norton, Cam Design and Manufacturing
    Handbook, chapter on dynamic models of cam-follower systems: one mass, industrial form without
    closing spring; Volmer, Kurvengetriebe, section on vibrations). From e'' + 2 D w e' + w^2 e =
    -y'' follows lambda = w (-D + i sqrt(1 - D^2)), e = Im u / (w sqrt(1 - D^2)).
    """
    root = math.sqrt((1.0 - damping) * (1.0 + damping))
    return Train(
        frozen([frequency * complex(-damping, root)], np.complex128),
        frozen([-1j / (frequency * root)], np.complex128),
    )


@dataclass(frozen=True, slots=True)
class Second:
    """A second mass on a spring and a damper on the first one.

    Attributes
    ----------
    frequency : its natural frequency with the first mass held fixed [rad/s].
    mass_ratio : to the first mass, above 0.
    damping : damping ratio, in [0, 1).
    """

    frequency: float
    mass_ratio: float
    damping: float


def two_masses(frequency: float, damping: float, second: Second, output: int = 1) -> Train:
    """Two masses in a row behind the base (Norton, same chapter: two masses).

    e_1'' = -2 D w e_1' - w^2 e_1 + m r - y'',  e_2'' = -r - y'',
    r = 2 D_2 w_2 (e_2' - e_1') + w_2^2 (e_2 - e_1),  m = `second.mass_ratio`;
    w and D are those of the first mass without the second. `output` is 1 for the deflection of the
    second mass, 0 for that of the first.
    """
    ratio, share = second.frequency / frequency, second.mass_ratio
    stiff, soft = ratio * ratio, 2.0 * second.damping * ratio
    # Over the time w t, so that the entries are dimensionless. State e_1, e_2, e_1', e_2'.
    matrix = np.array(
        [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-1.0 - share * stiff, share * stiff, -2.0 * damping - share * soft, share * soft],
            [stiff, -stiff, soft, -soft],
        ]
    )
    values, vectors = np.linalg.eig(matrix)
    rates: ComplexArray = values.astype(np.complex128)
    vectors = vectors.astype(np.complex128)
    parts = np.linalg.solve(vectors, np.array([0.0, 0.0, 1.0, 1.0], dtype=np.complex128))
    rates.real = np.minimum(rates.real, 0.0)  # the rounding of the solver may make it positive
    if damping == 0.0 and second.damping == 0.0:
        rates.real = 0.0  # no damping
    weights = vectors[output] * parts
    kept = np.flatnonzero(rates.imag >= 0.0)
    kept = kept[np.argsort(np.abs(rates[kept]), kind="stable")]
    weights = np.where(rates.imag > 0.0, 2.0 * weights, weights)
    return Train(
        frozen(frequency * rates[kept], np.complex128),
        frozen(weights[kept] / frequency, np.complex128),
        float(np.linalg.cond(vectors / np.max(np.abs(vectors), axis=1, keepdims=True))),
    )
