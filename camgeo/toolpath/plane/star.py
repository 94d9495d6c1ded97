"""Closed contours that every ray from a pole meets once: their distance from it by direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, ascending
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.units import TURN

STEEPEST = 0.05
"""Least cosine of the angle between a ray's normal and the contour: a steeper one is refused."""

SPLIT = 0.5 * np.pi
"""Arcs are cut into parts of at most this sweep, so that none reaches round its centre."""


@dataclass(frozen=True, slots=True, eq=False)
class Star:
    """A contour seen from the pole.

    Attributes
    ----------
    pole : complex [mm].
    angles : (n,) [rad] directions at which the pieces begin, ascending from `angles[0]` over less
        than one turn.
    starts, ends, centres : (n,) complex [mm] of the pieces, relative to the pole.
    sweeps : (n,) [rad].
    """

    pole: complex
    angles: FloatArray
    starts: ComplexArray
    ends: ComplexArray
    centres: ComplexArray
    sweeps: FloatArray

    @classmethod
    def of(cls, contour: Contour, pole: complex = 0j) -> Self | None:
        """The contour seen from `pole`.

        None if some ray may meet it more than once, or nearly along it.
        """
        pieces = contour.counter_clockwise().split(SPLIT)
        starts, ends = pieces.vertices - pole, pieces.ends - pole
        centres, sweeps = pieces.centres - pole, pieces.sweeps
        turns = np.angle(ends * np.conj(starts))
        if np.min(_uprightness(starts, ends, centres, sweeps)) < STEEPEST:
            return None
        if np.any(turns <= 0.0) or abs(float(np.sum(turns)) - 2.0 * np.pi) > 1e-6:
            return None
        angles = float(np.angle(starts[0])) + np.concatenate(([0.0], np.cumsum(turns)[:-1]))
        return cls(pole, angles, starts, ends, np.where(sweeps == 0.0, 0.0, centres), sweeps)

    def at(self, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m,) distances r [mm] from the pole in `directions` (m,) [rad], and dr/d(direction)."""
        ahead = np.mod(directions - self.angles[0], 2.0 * np.pi) + self.angles[0]
        index = np.clip(np.searchsorted(self.angles, ahead, "right") - 1, 0, len(self.angles) - 1)
        ray = np.exp(1j * directions)
        start, centre, sweep = self.starts[index], self.centres[index], self.sweeps[index]
        chord = self.ends[index] - start
        straight = (np.conj(start) * chord).imag / (np.conj(ray) * chord).imag
        seen = np.conj(ray) * centre
        foot, off = seen.real, seen.imag
        half = np.sqrt(np.maximum(np.abs(start - centre) ** 2 - off * off, 0.0))
        r = np.where(sweep == 0.0, straight, foot + np.sign(sweep) * half)
        along = np.where(sweep == 0.0, chord, 1j * np.sign(sweep) * (r * ray - centre))
        turned = np.conj(ray) * along
        return r, r * turned.real / turned.imag

    def distances(self, beyond: Star | None = None) -> Extremes:
        """Smallest and largest distance [mm] from the pole, or `beyond` another contour about the
        same pole, each with its direction [rad].
        """
        stars = [self] if beyond is None else [self, beyond]
        turns = np.concatenate([np.mod(star.angles, TURN) for star in stars])

        def distance(directions: FloatArray, _: Side) -> FloatArray:
            own = self.at(directions)[0]
            return own if beyond is None else own - beyond.at(directions)[0]

        return piecewise_extremes(distance, ascending(np.append(turns, [0.0, TURN])))

    def along(self, direction: float) -> float:
        """Distance [mm] along the contour, counter-clockwise from its first vertex, to where the
        ray in `direction` [rad] meets it.
        """
        point = complex(self.points(np.array([direction]))[0]) - self.pole
        ahead = (direction - self.angles[0]) % (2.0 * np.pi) + self.angles[0]
        index = max(int(np.searchsorted(self.angles, ahead, "right")) - 1, 0)
        arms = self.starts - self.centres
        straight = np.abs(self.ends - self.starts)
        lengths = np.where(self.sweeps == 0.0, straight, np.abs(self.sweeps * arms))
        way = abs(point - self.starts[index])
        if self.sweeps[index]:
            turned = np.angle((point - self.centres[index]) / arms[index])
            way = abs(turned) * abs(arms[index])
        return float(np.sum(lengths[:index]) + way)

    def points(self, directions: FloatArray) -> ComplexArray:
        """(m,) complex [mm] of the contour in `directions` (m,) [rad]."""
        found: ComplexArray = self.pole + self.at(directions)[0] * np.exp(1j * directions)
        return found


def _uprightness(
    starts: ComplexArray, ends: ComplexArray, centres: ComplexArray, sweeps: FloatArray
) -> FloatArray:
    """(n,) the least cosine along each piece of the angle between it and the normal of the ray.

    It is weighted by the distance from the pole over the least one of the piece's ends.
    """
    chord = ends - starts
    size = np.where(chord == 0.0, 1.0, np.abs(chord))
    straight = (np.conj(starts) * chord).imag / size
    radius = np.abs(starts - centres)
    sign = np.where(sweeps < 0.0, -1.0, 1.0)
    arms = [each - centres for each in (starts, ends)]
    off = np.abs(centres)
    toward = np.where(off > 0.0, -centres / np.where(off > 0.0, off, 1.0), 1.0)
    unit = np.where(radius > 0.0, radius, 1.0)
    # p = c + R a with |a| = 1; p x t = sign (R + c . a), least where a points back to the pole.
    values = [sign * (radius + (np.conj(centres) * arm).real / unit) for arm in arms]
    least = np.minimum(*values)
    inner = sign * toward
    turned = np.mod(sign * np.angle(inner * np.conj(arms[0])), 2.0 * np.pi)
    there = sign * (radius + (np.conj(centres) * inner).real)
    least = np.where(turned < np.abs(sweeps), np.minimum(least, there), least)
    reach = np.minimum(np.abs(starts), np.abs(ends))
    found: FloatArray = np.where(sweeps == 0.0, straight, least) / np.where(reach > 0.0, reach, 1.0)
    return found
