"""Chains of pieces along a stretch of the curve, and their closing to a contour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Pieces along one smooth piece of the curve, open at its end.

    Attributes
    ----------
    angles : (n,) [rad] cam angles of the pieces' starts.
    vertices, sweeps, centres : (n,), as of `Contour`.
    """

    angles: FloatArray
    vertices: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray


def closed(chains: list[Chain]) -> tuple[Contour, FloatArray]:
    """The contour of all chains in turn, and the cam angles of its vertices."""
    return (
        Contour(
            np.concatenate([chain.vertices for chain in chains]),
            np.concatenate([chain.sweeps for chain in chains]),
            np.concatenate([chain.centres for chain in chains]),
        ),
        np.concatenate([chain.angles for chain in chains]),
    )
