"""Elastic trains, decomposed into their modes.

The base moves by y(t), the masses by x_i; e_i = x_i - y is the deflection. A force p(t) may act on
the mass that is the output. Each mode obeys u' = lambda u - y'' and v' = lambda v + p, see
`camgeo.dynamics.oscillator.steady`; every motion and every force in the train is
Re sum (w u + z v) + a y + b y', with weights w and z of its own, and an acceleration has a part of
p besides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, read_only

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
        return self._modal_sum(read.weights, s) - (read.lift / s + read.slope) / s

    def compliance(self, frequency: float) -> complex:
        """Deflection of the output by a harmonic p of the circular `frequency` [rad/s], less that
        by a constant p.
        """
        still = self.yielding(self.deflection(self.output))
        return self._modal_sum(self.loaded[self.output], 1j * frequency) - still

    def _modal_sum(self, weights: ComplexArray, s: complex) -> complex:
        difference = s - self.rates
        near = np.abs(difference) < EPS * np.abs(self.rates)
        # At an undamped mode the distance is a rounding, not 0.
        difference = np.where(near, EPS * np.abs(self.rates), difference)
        return complex(
            0.5 * np.sum(weights / difference + weights.conj() / (s - self.rates.conj()))
        )


# -- chain ----------------------------------------------------------------------------------------
# Masses in a row behind a moving base, joined by springs and dampers: their modes.
#
# With the deflections x_i from the frame, x_0 = y of the base, and the links kappa_i = k_i + c_i s,
#
#     m_i s^2 x_i + (h_i s + g_i) x_i + kappa_i (x_i - x_{i-1}) - kappa_{i+1} (x_{i+1} - x_i) = 0
#
# (Norton, Cam Design and Manufacturing Handbook, chapter on dynamic models of cam-follower systems,
# has it for one and two masses). Everything is computed from the impedances of what is ahead of a
# mass and of what is behind it, which follow link by link, as springs in series and in parallel:
# their sums magnify no rounding, however different the masses and stiffnesses. The eigenvalue
# problem of the whole train gives the first approximation of the poles, in the form
#
#     z' = [[0, R], [-R^T, -C]] z,      R^T R = M^-1/2 K M^-1/2, C = M^-1/2 (damping) M^-1/2,
#
# which has the poles' own magnitude, not its square; and it is orthogonal without damping. Each
# pole is then corrected by its Rayleigh quotient (F. Tisseur and K. Meerbergen, SIAM Review 43
# (2001) 235-286, sections 3.4 and 5): for x^T Q(s) x = 0, the next one is s - x^T Q x / x^T Q' x.
# The vector x follows from the mass k where the impedance is smallest, outwards to both ends (I. S.
# Dhillon and B. N. Parlett, Linear Algebra Appl. 387 (2004) 1-28, twisted factorisations).
#
# Poles that nearly coincide, as with critical damping, have nearly the same vector, and huge
# weights of opposite sign. What they do together is Cauchy's integral of the response over a circle
# around them, whose points then stand for modes; the sum over equally spaced points converges like
# a power of the radii (L. N. Trefethen and J. A. C. Weideman, SIAM Review 56 (2014) 385-458).


@dataclass(frozen=True, slots=True)
class Stage:
    """A mass with the spring and damper in front of it; in any consistent units.

    Attributes
    ----------
    mass : above 0.
    stiffness : of the spring to the mass in front, or to the base; above 0.
    damping : of the damper beside it.
    ground_stiffness, ground_damping : of a spring and a damper to the frame.
    """

    mass: float
    stiffness: float
    damping: float = 0.0
    ground_stiffness: float = 0.0
    ground_damping: float = 0.0


CORRECTIONS: Final = 8
"""Most corrections of a pole. They converge cubically; three do from seven digits."""

SIMPLE: Final = 30.0
"""Magnification of rounding up to which a pole is taken by itself."""

SEPARATION: Final = 4.0
"""Poles are taken together if the others, and the imaginary axis, are this many times as far from
the centre as they are. The circle lies in the middle of both, by the factor 2 at least."""

POINTS: Final = 56
"""Points on a circle; 2^-56 is below rounding."""


class SeparationError(ArithmeticError):
    """The modes found do not make up the train: its data differ too much in magnitude."""


@dataclass(frozen=True, slots=True, eq=False)
class _StageArrays:
    """The stages as (n,) arrays; base and frame at rest."""

    m: FloatArray
    k: FloatArray
    c: FloatArray
    g: FloatArray
    h: FloatArray

    def impedances(self, s: ComplexArray) -> Impedances:
        """The impedances at `s` (q,)."""
        column = s[:, np.newaxis]
        body = (self.m * column + self.h) * column + self.g
        link = self.k + self.c * column
        to_back, to_front = body.copy(), body.copy()
        count = len(self.m)
        for i in range(count - 2, -1, -1):
            to_back[:, i] += in_series(link[:, i + 1], to_back[:, i + 1])
        to_front[:, 0] += link[:, 0]
        for i in range(1, count):
            to_front[:, i] += in_series(link[:, i], to_front[:, i - 1])
        return Impedances(s, body, link, to_back, to_front)

    def normed(self, s: ComplexArray, x: ComplexArray, bent: ComplexArray) -> ComplexArray:
        """(q,) x^T Q'(s) x, with `bent` x_i - x_{i-1}."""
        column = s[:, np.newaxis]
        norm = np.sum((2.0 * self.m * column + self.h) * x**2, axis=1)
        return np.asarray(norm + np.sum(self.c * bent**2, axis=1))

    def pushes(
        self,
        impedances: Impedances,
        x: ComplexArray,
        bent: ComplexArray,
        held: ComplexArray | float = 0.0,
    ) -> ComplexArray:
        """(q, n) forces in the links, positive if they push the mass behind.

        Each is what its spring and damper exert, or what all masses behind it take but for the
        force `held` (q, n) that acts on them; these are equal, and the one in which less cancels is
        taken: the spring and the damper of a strongly damped mode nearly do.
        """
        size = np.abs(impedances.s)[:, np.newaxis]
        here = (self.k + self.c * size) * np.abs(bent)
        absorbed = ((self.m * size + self.h) * size + self.g) * np.abs(x)
        behind = np.cumsum(absorbed[:, ::-1], axis=1)[:, ::-1]
        sums = np.cumsum((impedances.body * x)[:, ::-1], axis=1)[:, ::-1] - held
        return np.where(here <= behind + np.abs(held), -impedances.link * bent, sums)

    def energy(self, s: ComplexArray, x: ComplexArray, bent: ComplexArray) -> FloatArray:
        """(q,) |x|^T |Q(s)| |x|, all by magnitudes: the scale of the rounding of x^T Q(s) x."""
        size = np.abs(s)[:, np.newaxis]
        body = (self.m * size + self.h) * size + self.g
        links = np.sum((self.k + self.c * size) * np.abs(bent) ** 2, axis=1)
        return np.asarray(np.sum(body * np.abs(x) ** 2, axis=1) + links)


def chain(stages: Sequence[Stage], output: int = -1) -> Train:
    """The train of the `stages`, from the base outwards; `output` is the index of its output.

    Raises
    ------
    SeparationError
        If the modes found leave out more than `LOST` of the motion.
    """
    rows = np.array(
        [
            (
                stage.mass,
                stage.stiffness,
                stage.damping,
                stage.ground_stiffness,
                stage.ground_damping,
            )
            for stage in stages
        ]
    )
    m, k, c, g, h = rows.T
    arrays = _StageArrays(m, k, c, g, h)
    last = range(len(stages))[int(output)]
    undamped = not np.any(c) and not np.any(h)
    poles, spread = _corrected(arrays, _approximate(arrays, undamped=undamped), undamped=undamped)
    circles, alone = _circles(poles, spread)
    simple = _pole_modes(arrays, poles[alone], spread[alone], last)
    parts = [simple, *(_circle_modes(arrays, *circle, last) for circle in circles)]
    static = _static(arrays)
    single = np.count_nonzero(alone)
    groups = [np.arange(single)]
    groups += [np.full(len(part.rates), single + i) for i, part in enumerate(parts[1:])]
    rates = np.concatenate([part.rates for part in parts])
    shapes = np.concatenate([part.shapes for part in parts], axis=1)
    missing = np.abs(np.sum((shapes * rates).real, axis=1) - static[:, 0])
    if not np.max(missing) <= LOST * max(1.0, float(np.max(np.abs(static[:, 0])))):
        raise SeparationError(f"the modes leave out {np.max(missing):.3g} of the motion")
    holds = static * g[:, np.newaxis]
    holds[:, 1] += h * static[:, 0]
    return Train(
        poles=read_only(poles),
        rates=read_only(rates),
        shapes=read_only(shapes),
        pushes=read_only(np.concatenate([part.pushes for part in parts], axis=1)),
        static=read_only(static),
        held=read_only(np.cumsum(holds[::-1], axis=0)[::-1]),
        group=read_only(np.concatenate(groups)),
        centre=read_only(np.append(poles[alone], [centre for centre, _ in circles])),
        drift=read_only(np.concatenate([part.drift for part in parts])),
        doubt=read_only(np.concatenate([part.doubt for part in parts])),
        stiffnesses=read_only(np.max(np.abs(k + np.multiply.outer(poles, c)), axis=0)),
        output=last,
        mass=float(m[last]),
        loaded=read_only(np.concatenate([part.loaded for part in parts], axis=1)),
        loaded_pushes=read_only(np.concatenate([part.loaded_pushes for part in parts], axis=1)),
    )


LOST: Final = 1e-4
"""Largest part of the motion that the modes may leave out before a train is refused."""


def one_mass(frequency: float, damping: float) -> Train:
    """x'' + 2 D w x' + w^2 x = 2 D w y' + w^2 y, with w = `frequency` [rad/s], D >= 0.

    A mass on a spring and a damper, both on the moving base (Norton, industrial form without
    closing spring; Volmer, Kurvengetriebe, section on vibrations). For D < 1 lambda = w (-D + i
    sqrt(1 - D^2)), e = Im u / (w sqrt(1 - D^2)).
    """
    return chain([Stage(1.0, frequency * frequency, 2.0 * damping * frequency)])


def _approximate(arrays: _StageArrays, *, undamped: bool) -> ComplexArray:
    """(p,) the poles with Im >= 0, to the rounding of the largest."""
    count = len(arrays.m)
    root = np.sqrt(arrays.m)
    # One row for each spring, scaled by the masses at its ends: springs^T springs = M^-1/2 K
    # M^-1/2.
    springs = np.zeros((2 * count, count))
    springs[:count] = np.diag(np.sqrt(arrays.k) / root)
    springs[np.arange(1, count), np.arange(count - 1)] = -np.sqrt(arrays.k[1:]) / root[:-1]
    springs[count:] = np.diag(np.sqrt(arrays.g) / root)
    triangle = np.linalg.qr(springs)[1]
    if undamped:
        return np.asarray(1j * np.linalg.svd(triangle, compute_uv=False))
    dampers = np.zeros((2 * count, count))
    dampers[:count] = np.diag(np.sqrt(arrays.c) / root)
    dampers[np.arange(1, count), np.arange(count - 1)] = -np.sqrt(arrays.c[1:]) / root[:-1]
    dampers[count:] = np.diag(np.sqrt(arrays.h) / root)
    system = np.block([[np.zeros((count, count)), triangle], [-triangle.T, -dampers.T @ dampers]])
    eigenvalues = np.linalg.eigvals(system).astype(np.complex128)
    upper: ComplexArray = eigenvalues[eigenvalues.imag >= 0.0]
    return upper


def _corrected(
    arrays: _StageArrays, poles: ComplexArray, *, undamped: bool
) -> tuple[ComplexArray, FloatArray]:
    """The poles, the slowest first, and (p,) the factor by which each magnifies rounding."""
    best = np.full(len(poles), math.inf)
    spread = np.full(len(poles), math.inf)
    corrected = poles
    for _ in range(CORRECTIONS):
        impedances = arrays.impedances(poles)
        whole = impedances.whole
        # Started where the impedance is smallest, the vector follows without cancellation.
        mass = np.argmin(np.abs(whole) / arrays.m, axis=1)
        x, bent = impedances.from_mass(mass)
        normed = arrays.normed(poles, x, bent)
        energy = arrays.energy(poles, x, bent)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            step = whole[np.arange(len(poles)), mass] / normed
            magnification = energy / np.abs(normed * poles)
        size = np.abs(step)
        better = size < best
        corrected = np.where(better, poles, corrected)
        # What the last correction would be is an error that remains, unless it is rounding.
        left = np.maximum(size / (EPS * np.abs(poles)) - ROUNDED * magnification, 0.0)
        spread = np.where(better, np.maximum(magnification, 1.0) + left, spread)
        best = np.where(better, size, best)
        # A pole is not left for another: the approximation is to its own rounding.
        poles = np.where(better & np.isfinite(step), poles - step, poles)
        poles.real = np.minimum(poles.real, 0.0)
        if undamped:
            poles.real = 0.0
        if not np.any(better):
            break
    order = np.argsort(np.abs(corrected), kind="stable")
    return corrected[order], spread[order]


ROUNDED: Final = 16.0
"""Roundings up to which a correction is rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class _ModeGroup:
    """Some of the modes, see `Train`."""

    rates: ComplexArray
    shapes: ComplexArray
    pushes: ComplexArray
    loaded: ComplexArray
    loaded_pushes: ComplexArray
    drift: FloatArray
    doubt: FloatArray


def _pole_modes(
    arrays: _StageArrays, poles: ComplexArray, spread: FloatArray, output: int
) -> _ModeGroup:
    """The modes of simple poles: the residues of the response to the base, by -lambda^2, and of
    that to a force on the `output`.
    """
    impedances = arrays.impedances(poles)
    x, bent = impedances.from_mass(np.argmin(np.abs(impedances.whole) / arrays.m, axis=1))
    pushes = arrays.pushes(impedances, x, bent)
    # A complex pole stands for its conjugate too.
    both = np.where(poles.imag > 0.0, 2.0, 1.0) / arrays.normed(poles, x, bent)
    scale, load = both * pushes[:, 0] / poles**2, both * x[:, output]
    return _ModeGroup(
        poles,
        (scale[:, np.newaxis] * x).T,
        (scale[:, np.newaxis] * pushes).T,
        (load[:, np.newaxis] * x).T,
        (load[:, np.newaxis] * pushes).T,
        spread,
        spread**2,
    )


def _circle_modes(arrays: _StageArrays, centre: complex, radius: float, output: int) -> _ModeGroup:
    """The points of the circle as modes. Around a real centre those above the axis stand for both
    halves.
    """
    way = np.exp(2j * math.pi * (np.arange(POINTS) + 0.5) / POINTS)
    if centre.imag == 0.0:
        # The lower half of the circle is the conjugate of the upper one.
        way = way[: POINTS // 2]
    rates = centre + radius * way
    impedances = arrays.impedances(rates)
    x, bent = impedances.from_base()
    ahead = (2.0 * radius / POINTS) * way
    scale = -ahead / rates**2
    # By Cauchy and Schwarz from the energies of the response to the base and to the output.
    whole = impedances.whole[:, output]
    z, slack = impedances.from_mass(np.full(len(rates), output))
    back = arrays.energy(rates, z, slack) / np.abs(whole)
    doubt = np.sqrt(arrays.energy(rates, x, bent) * back / np.abs(whole)) / np.abs(x[:, output])
    load = ahead / whole
    held = np.where(np.arange(len(arrays.m)) <= output, whole[:, np.newaxis], 0.0)
    return _ModeGroup(
        rates,
        (scale[:, np.newaxis] * x).T,
        (scale[:, np.newaxis] * arrays.pushes(impedances, x, bent)).T,
        (load[:, np.newaxis] * z).T,
        (load[:, np.newaxis] * arrays.pushes(impedances, z, slack, held)).T,
        np.ones(len(rates)),
        np.maximum(np.maximum(doubt, back), 1.0),
    )


def _circles(
    poles: ComplexArray, spread: FloatArray
) -> tuple[list[tuple[complex, float]], BoolArray]:
    """Circles around poles that magnify rounding, and (p,) which poles are in none."""
    alone = np.ones(len(poles), dtype=bool)
    circles = []
    both = np.concatenate((poles, poles[poles.imag > 0.0].conj()))
    for i in np.argsort(-spread, kind="stable").tolist():
        if spread[i] <= SIMPLE:
            break
        if alone[i] and (circle := _around(both, poles[i])) is not None:
            centre, radius = circle
            inside = np.abs(poles - centre) < radius
            if np.all(alone[inside]):
                alone[inside] = False
                circles.append(circle)
    return circles, alone


def _around(poles: ComplexArray, pole: complex) -> tuple[complex, float] | None:
    """The circle around `pole` and its nearest neighbours that is farthest from all others."""
    ordered = poles[np.argsort(np.abs(poles - pole), kind="stable")]
    best, circle = SEPARATION, None
    for count in range(2, len(ordered) + 1):
        inside, others = ordered[:count], ordered[count:]
        # A group with poles on both sides of the real axis is symmetric about it.
        if np.any(inside.imag > 0.0) and np.any(inside.imag <= 0.0):
            centre = complex(np.mean(inside.real))
        else:
            centre = complex(np.mean(inside))
        inner_radius = float(np.max(np.abs(inside - centre)))
        outer_radius = float(np.min(np.abs(others - centre), initial=abs(centre.real)))
        if outer_radius > 0.0 and outer_radius >= best * inner_radius:
            best, circle = (
                outer_radius / max(inner_radius, EPS * outer_radius),
                (centre, 0.5 * outer_radius),
            )
    return circle


def _static(arrays: _StageArrays) -> FloatArray:
    """(n, 2) the response to a slow motion of the base, G(0) and G'(0).

    Behind a mass, springs to the frame act as one of stiffness b, and as a damper d.
    """
    count = len(arrays.m)
    stiff, damp = arrays.g.copy(), arrays.h.copy()
    share, lag = np.ones(count), np.zeros(count)
    for i in range(count - 1, -1, -1):
        total = arrays.k[i] + stiff[i]
        part = arrays.k[i] / total
        share[i] = part
        # d/ds of kappa / (kappa + b + d s) at 0
        lag[i] = (arrays.c[i] * (stiff[i] / total) - part * damp[i]) / total
        if i > 0:
            stiff[i - 1] += part * stiff[i]
            damp[i - 1] += part * part * damp[i] + (stiff[i] / total) ** 2 * arrays.c[i]
    gain = np.cumprod(share)
    slope = np.zeros(count)
    gain_ahead, rise = 1.0, 0.0
    for i in range(count):
        rise = rise * share[i] + gain_ahead * lag[i]
        gain_ahead = gain[i]
        slope[i] = rise
    return np.stack((gain, slope), axis=1)


# -- impedances -----------------------------------------------------------------------------------
# Impedances along a train of masses, springs and dampers: force by displacement.


@dataclass(frozen=True, slots=True, eq=False)
class Impedances:
    """Force by displacement, (q, n) each.

    Attributes
    ----------
    s : (q,).
    body : of the mass with what holds it to the frame.
    link : of the spring and damper in front of it.
    to_back : of the mass with all behind it.
    to_front : of the mass with all in front of it, the base at rest.
    """

    s: ComplexArray
    body: ComplexArray
    link: ComplexArray
    to_back: ComplexArray
    to_front: ComplexArray

    @property
    def whole(self) -> ComplexArray:
        """(q, n) force at a mass by its displacement, with the whole train around it."""
        impedance = self.to_front.copy()
        impedance[:, :-1] += in_series(self.link[:, 1:], self.to_back[:, 1:])
        return impedance

    def from_mass(self, mass: IntArray) -> tuple[ComplexArray, ComplexArray]:
        """(q, n) displacements while that of the `mass` (q,) is 1, and the x_i - x_{i-1}."""
        rows, count = np.arange(len(self.s)), self.body.shape[1]
        x = np.zeros_like(self.body)
        bent = np.zeros_like(self.body)
        x[rows, mass] = 1.0
        for i in range(1, count):
            behind = i > mass
            stretch = _divided(self.to_back[:, i], self.link[:, i] + self.to_back[:, i])
            share = _divided(self.link[:, i], self.link[:, i] + self.to_back[:, i])
            x[:, i] = np.where(behind, share * x[:, i - 1], x[:, i])
            bent[:, i] = np.where(behind, -stretch * x[:, i - 1], bent[:, i])
        for i in range(count - 1, 0, -1):
            ahead = i <= mass
            front = self.to_front[:, i - 1]
            stretch = _divided(front, self.link[:, i] + front)
            share = _divided(self.link[:, i], self.link[:, i] + front)
            x[:, i - 1] = np.where(ahead, share * x[:, i], x[:, i - 1])
            bent[:, i] = np.where(ahead, stretch * x[:, i], bent[:, i])
        bent[:, 0] = x[:, 0]
        return x, bent

    def from_base(self) -> tuple[ComplexArray, ComplexArray]:
        """(q, n) displacements while that of the base is 1, and the x_i - x_{i-1}."""
        total = self.link[:, 0] + self.to_back[:, 0]
        first = _divided(self.link[:, 0], total)
        x, bent = self.from_mass(np.zeros(len(self.s), dtype=np.intp))
        x, bent = first[:, np.newaxis] * x, first[:, np.newaxis] * bent
        bent[:, 0] = -_divided(self.to_back[:, 0], total)
        return x, bent


def _divided(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """a / b, with a tiny b for 0: an impedance that vanishes is one that nearly does."""
    quotient: ComplexArray = a / np.where(b == 0.0, EPS * EPS * np.maximum(np.abs(a), 1e-250), b)
    return quotient


def in_series(link: ComplexArray, load: ComplexArray) -> ComplexArray:
    """The impedance of a `link` with a `load` behind it, seen from in front of the link."""
    return link * _divided(load, link + load)
