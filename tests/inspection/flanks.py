"""Flanks of the fixture scenes, and points measured on them."""

from __future__ import annotations

import cmath
from functools import cache
from pathlib import Path

import numpy as np

import camgeo
from camgeo.design.product import Product
from camgeo.geometry.outline.exact_flank import ExactFlank, Places
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import ComplexArray, FloatArray

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

KINDS = (
    ("plate_translating", Flank.INNER),  # a roller on a guide
    ("setzhub", Flank.INNER),  # a rocker's, behind a linkage
    ("groove", Flank.INNER),
    ("groove", Flank.OUTER),
    ("tappet", Flank.INNER),  # a flat face
    ("flat_rocker", Flank.INNER),
    ("ring", Flank.OUTER),
)

TRIMMED = (
    ("swallow_tail", Flank.INNER),
    ("trimmed_ring", Flank.OUTER),
    ("straight_moves", Flank.INNER),  # turns of the roller about its centre
)

BUMP = 5e-3
"""Height of an error of form [mm]."""

AT, HALF = np.radians(60.0), np.radians(10.0)
"""Its middle, and half its width, in cam angle [rad]."""


@cache
def disc_of(name: str) -> Product:
    return camgeo.load(SCENES / f"{name}.toml").disc


@cache
def flank_of(name: str, side: Flank) -> ExactFlank:
    return ExactFlank(disc_of(name).cam.disc.outline(side).path, side)


def every(flank: ExactFlank, count: int) -> Places:
    """Places evenly over the path."""
    course: FloatArray = (np.arange(count, dtype=np.float64) + 0.25) * (flank.total / count)
    return flank.places(course)


def bump(phi: FloatArray) -> FloatArray:
    """An error of form [mm] over 20 degrees of cam angle."""
    x = (phi - AT) / HALF
    return np.where(np.abs(x) < 1.0, 0.5 * BUMP * (1.0 + np.cos(np.pi * x)), 0.0)


def measured(
    places: Places, deviations: FloatArray | float, shift: complex = 0j, turn: float = 0.0
) -> ComplexArray:
    """Points at `deviations` [mm] from the places, of a part that is shifted and turned."""
    points: ComplexArray = places.points + deviations * places.normals
    return shift + cmath.exp(1j * turn) * points
