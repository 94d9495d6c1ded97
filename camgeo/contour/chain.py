"""Chains of pieces along the legs of a path, and their closing to a contour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.legs import Leg
from camgeo.numeric.arrays import ComplexArray, FloatArray, joined


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Pieces along one smooth piece of a leg, open at its end.

    Attributes
    ----------
    angles : (n,) [rad] parameters of the pieces' starts.
    vertices, sweeps, centres : (n,), as of `Contour`.
    """

    angles: FloatArray
    vertices: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    @classmethod
    def straight(cls, angles: FloatArray, vertices: ComplexArray) -> Self:
        """Lines that start at `vertices` (n,)."""
        return cls(angles, vertices, np.zeros(len(angles)), np.zeros_like(vertices))

    @classmethod
    def empty(cls) -> Self:
        """No pieces at all."""
        return cls.straight(np.empty(0), np.empty(0, dtype=np.complex128))

    @classmethod
    def arc(cls, angle: float, start: complex, sweep: float, centre: complex) -> Self:
        """One arc."""
        return cls(np.array([angle]), np.array([start]), np.array([sweep]), np.array([centre]))


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """All pieces of a contour along one leg, in the direction of the leg.

    Attributes
    ----------
    leg : the exact leg.
    angles : (n + 1,) [rad] parameters of the leg that belong to the vertices, ascending.
    vertices : (n + 1,) complex [mm] ends of the pieces; n = 0 if the leg is too short for a piece.
    sweeps, centres : (n,), as of `Contour`.
    """

    leg: Leg
    angles: FloatArray
    vertices: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    @property
    def starts(self) -> ComplexArray:
        """(n,) complex [mm], start of each piece."""
        return self.vertices[:-1]

    @property
    def ends(self) -> ComplexArray:
        """(n,) complex [mm], end of each piece."""
        return self.vertices[1:]

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] radius of each arc; 0 for lines."""
        return np.where(self.sweeps != 0.0, np.abs(self.starts - self.centres), 0.0)


def runs_of(parts: list[tuple[Leg, list[Chain]]]) -> tuple[Run, ...]:
    """The runs of all legs in turn, each ending in the first vertex of the next.

    Where a leg begins at a corner or an arc, its first vertex is the exact point there, not that
    point as rounded by its own curve.
    """
    whole = [_joined_chain(leg, chains) for leg, chains in parts]
    runs: list[Run] = []
    following: complex = next(complex(chain.vertices[0]) for chain in whole if len(chain.vertices))
    for (leg, _), chain in reversed(list(zip(parts, whole, strict=True))):
        closing = chain.angles[0] + (leg.end - leg.start) if leg.closed else leg.end
        vertices = np.append(chain.vertices, following)
        angles = np.append(chain.angles, closing)
        runs.insert(0, Run(leg, angles, vertices, chain.sweeps, chain.centres))
        following = complex(vertices[0])
    return tuple(runs)


def _joined_chain(leg: Leg, chains: list[Chain]) -> Chain:
    chain = joined(chains)
    if leg.first is not None and len(chain.vertices):
        chain.vertices[0] = leg.first
    return chain


def contour_of(runs: tuple[Run, ...]) -> Contour:
    """The closed contour of all runs in turn."""
    return Contour(
        np.concatenate([run.starts for run in runs]),
        np.concatenate([run.sweeps for run in runs]),
        np.concatenate([run.centres for run in runs]),
    )
