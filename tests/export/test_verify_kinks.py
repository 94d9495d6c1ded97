"""Kinks of written contours: those explained by the exact outline's bend, and others."""

from __future__ import annotations

import math

import numpy as np

from camgeo.design.verify import Check
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.boundaries import ExactBoundary
from camgeo_export.verify.plane import contour_checks, shapes_of

SIDES = 12

SIDE = 40.0

ROUNDING = 0.05
"""Radius of the corners [mm], far less than the tolerance."""

TOLERANCE = 0.1


def corners() -> ComplexArray:
    """Of a regular polygon whose sides turn by 30 degrees from one to the next."""
    radius = 0.5 * SIDE / math.sin(math.pi / SIDES)
    return np.asarray(radius * np.exp(2j * math.pi * np.arange(SIDES) / SIDES))


def sharp() -> Contour:
    """The polygon, its sides halved: what chords of the rounded one may be."""
    ends = corners()
    vertices = np.ravel(np.column_stack((ends, 0.5 * (ends + np.roll(ends, -1)))))
    return Contour.through(vertices, np.zeros(len(vertices)))


def kink(contour: Contour) -> Check:
    """The check of `contour` against the polygon with its corners rounded off."""
    ends, turn = corners(), 2.0 * math.pi / SIDES
    along = np.roll(ends, -1) - ends
    along /= np.abs(along)
    cut = ROUNDING * math.tan(0.5 * turn)
    vertices = np.ravel(np.column_stack((ends - cut * np.roll(along, 1), ends + cut * along)))
    exact = Contour.through(vertices, np.tile([turn, 0.0], SIDES))
    (shape,) = shapes_of((ExactBoundary("outline", hole=False, exact=exact),), 150.0, TOLERANCE)
    found = contour_checks(shape, contour, TOLERANCE)
    return {check.name: check for check in found}["kink"]


def test_a_bend_within_a_piece_is_no_fault_of_chords() -> None:
    check = kink(sharp())
    assert math.isclose(float(check.value or 0.0), 30.0, rel_tol=1e-9)
    assert check.ok


def test_a_kink_where_the_outline_is_straight_is_reported() -> None:
    contour = sharp()
    vertices = contour.vertices.copy()
    vertices[1] *= 0.8
    check = kink(Contour.through(vertices, np.zeros(len(vertices))))
    assert check.ok is False
    assert float(check.value or 0.0) > 30.0
