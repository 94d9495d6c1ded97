"""Normals that a file states next to its points, compared with the true ones.

A measuring machine subtracts the radius of its ball along the normal that it is given. Normals that
point along the radius from the cam axis, as computed from a table of polar coordinates, are off by
the angle delta between normal and radius, and the point that results is off the flank by
r (1 - cos delta) for a ball of radius r: the flank seems to have more material than it has.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.inspection.exact_flank import Feet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.extremes import Extreme

TELLING: Final = np.radians(1.0)
"""Least angle [rad] between normal and radius at which the two can be told apart."""


@dataclass(frozen=True, slots=True)
class StatedNormals:
    """What is found of the normals.

    Attributes
    ----------
    largest : angle [rad] of the one farthest from the true normal, with its cam angle.
    into_material : whether they point into the material; their angles are then taken reversed.
    radial : whether most of those that tell are nearer to the radius than to the true normal.
    """

    largest: Extreme
    into_material: bool
    radial: bool


def off_radius(feet: Feet) -> FloatArray:
    """(n,) angle [rad] delta between the true normal and the radius from the cam axis, signed as
    the normal is turned from the radius, which points to the side of the normal.
    """
    radii = feet.places.points / np.abs(feet.places.points)
    turned = feet.places.normals * radii.conj()
    return np.angle(np.where(turned.real < 0.0, -turned, turned))


def false_share(delta: FloatArray) -> FloatArray:
    """(n,) 1 - cos delta, the deviation per radius of the ball that radial normals feign."""
    return 2.0 * np.sin(0.5 * delta) ** 2


def stated_normals(feet: Feet, turn: float, normals: ComplexArray) -> StatedNormals:
    """Compare the `normals` (n,) of points, of any length but 0, with those at their `feet`, where
    the part is turned by `turn` [rad] in the axes of the measurement.
    """
    off = normals * np.exp(-1j * turn) * feet.places.normals.conj()
    into_material = bool(np.median(off.real) < 0.0)
    angles = np.angle(-off if into_material else off)
    # The radius lies at -delta from the true normal.
    delta = off_radius(feet)
    telling = np.abs(delta) > TELLING
    nearer = np.abs(angles + delta) < np.abs(angles)
    radial = bool(np.any(telling) and np.mean(nearer[telling]) > 0.5)
    worst = int(np.argmax(np.abs(angles)))
    largest = Extreme(float(abs(angles[worst])), float(feet.places.phi[worst]))
    return StatedNormals(largest, into_material, radial)
