"""Elastic trains, decomposed into their modes.

The base moves by y(t), the masses by x_i; e_i = x_i - y is the deflection. A force p(t) may act on
the mass that is the output. Each mode obeys u' = lambda u - y'' and v' = lambda v + p, see
`camgeo.numeric.oscillator.mode`; every motion and every force in the train is
Re sum (w u + z v) + a y + b y', with weights w and z of its own, and an acceleration has a part of
p besides.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray

EPS: Final = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What is read off the modes: Re sum (w u + z v) + a y + b y' + d p.

    Attributes
    ----------
    weights : (m,) w.
    lift, slope : a, b.
    loaded : (m,) z.
    direct : d.
    """

    weights: ComplexArray
    lift: float = 0.0
    slope: float = 0.0
    loaded: ComplexArray | float = 0.0
    direct: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Train:
    """The modes of an elastic train of n masses.

    Attributes
    ----------
    poles : (p,) roots of the characteristic equation [1/s], Im >= 0; one of each conjugate pair
        represents both; the slowest first.
    rates : (m,) lambda [1/s] of the modes: the poles, with points on a circle around those that
        nearly coincide instead of these.
    shapes : (n, m) weights of the masses' motions x_i.
    pushes : (n, m) weights of the forces in the links, see `force`.
    static : (n, 2) a and b of x_i: as y moves slowly, x_i = a y + b y'.
    held : (n, 2) a and b of the forces in the links.
    group, centre : (m,) number of the group of poles that a mode represents, one pole or a circle,
        and (g,) the centre of each group.
    drift, doubt : (m,) factors by which the data's rounding is magnified in lambda, and in the
        weights.
    stiffnesses : (n,) largest magnitude of force by deflection of each link, over the modes.
    output : index of the mass whose motion is the output.
    mass : of the output.
    loaded, loaded_pushes : (n, m) the weights of the v in the motions and in the forces.
    """

    poles: ComplexArray
    rates: ComplexArray
    shapes: ComplexArray
    pushes: ComplexArray
    static: FloatArray
    held: FloatArray
    group: IntArray
    centre: ComplexArray
    drift: FloatArray
    doubt: FloatArray
    stiffnesses: FloatArray
    output: int
    mass: float
    loaded: ComplexArray
    loaded_pushes: ComplexArray

    def deflection(self, mass: int) -> Reading:
        """e of the `mass`. The base's velocity may jump; no mass moves at once."""
        lift, slope = self.static[mass].tolist()
        return Reading(self.shapes[mass], lift - 1.0, slope, self.loaded[mass])

    def velocity(self, mass: int) -> Reading:
        """e' of the `mass`."""
        lift, loaded = float(self.static[mass, 0]), self.loaded[mass] * self.rates
        return Reading(self.shapes[mass] * self.rates, 0.0, lift - 1.0, loaded)

    def acceleration(self, mass: int) -> Reading:
        """x'' of the `mass`."""
        square = self.rates**2
        direct = 1.0 / self.mass if mass == self.output else 0.0
        return Reading(self.shapes[mass] * square, loaded=self.loaded[mass] * square, direct=direct)

    def force(self, link: int) -> Reading:
        """The force in the spring and damper in front of mass `link`, positive if they push it.

        It accelerates all masses behind and moves what holds them, sum m x'' + h x' + g x, against
        the force p on one of them.
        """
        lift, slope = self.held[link].tolist()
        return Reading(self.pushes[link], lift, slope, self.loaded_pushes[link])

    def yielding(self, reading: Reading) -> float:
        """`reading` under a force of 1 that lasts on the output, with the base at rest at 0."""
        return reading.direct - float(np.sum((reading.loaded / self.rates).real))

    def in_time(self, factor: float) -> Train:
        """The same train over a time that passes `factor` times as fast; forces are in this time.

        Of the same masses, with stiffnesses by factor^2 and dampers by factor less.
        """
        once = np.array([1.0, factor])
        return replace(
            self,
            poles=self.poles / factor,
            rates=self.rates / factor,
            shapes=self.shapes * factor,
            pushes=self.pushes / factor,
            static=self.static * once,
            held=self.held * once / factor**2,
            centre=self.centre / factor,
            stiffnesses=self.stiffnesses / factor**2,
            loaded=self.loaded * factor,
            loaded_pushes=self.loaded_pushes / factor,
        )

    def transfer(self, frequency: float) -> complex:
        """Deflection of the output by -y'' if y is a harmonic of that circular `frequency` [rad/s].

        At the frequency of an undamped mode it is as large as one rounding away from it.
        """
        s = 1j * frequency
        read = self.deflection(self.output)
        return self._of_modes(read.weights, s) - (read.lift / s + read.slope) / s

    def compliance(self, frequency: float) -> complex:
        """The same by p, less that by a p that lasts."""
        still = self.yielding(self.deflection(self.output))
        return self._of_modes(self.loaded[self.output], 1j * frequency) - still

    def _of_modes(self, weights: ComplexArray, s: complex) -> complex:
        apart = s - self.rates
        near = np.abs(apart) < EPS * np.abs(self.rates)
        apart = np.where(near, EPS * np.abs(self.rates), apart)
        return complex(0.5 * np.sum(weights / apart + weights.conj() / (s - self.rates.conj())))
