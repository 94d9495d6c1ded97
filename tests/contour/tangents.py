"""Tangents of contours: corners are where they must be and nowhere else."""

from __future__ import annotations

import numpy as np

from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray

PLACE = 1e-13
"""Rounding of a point of a curve some 100 mm from the axis: 8 ulp [mm]."""


def tangents(contour: Contour) -> tuple[ComplexArray, ComplexArray]:
    """Unit tangents at the start and at the end of each piece."""
    arm = contour.vertices - contour.centres
    chord = contour.ends - contour.vertices
    along: ComplexArray = np.where(contour.sweeps != 0.0, 1j * np.sign(contour.sweeps) * arm, chord)
    along /= np.abs(along)
    last: ComplexArray = along * np.exp(1j * contour.sweeps)
    return along, last


def check_tangent(contour: Contour, except_at: ComplexArray) -> None:
    """No corner: neighbours turn by no more than the rounding of end points over a piece."""
    first, last = tangents(contour)
    turns = np.abs(np.angle(np.roll(first, -1) * np.conj(last)))
    shorter = np.minimum(contour.lengths, np.roll(contour.lengths, -1))
    # Both tangents come from chords whose ends are PLACE off; an arc written as a line, with a
    # sagitta of up to 1e-10 mm, turns by 4e-10 over its length.
    lines = (contour.sweeps == 0.0) | (np.roll(contour.sweeps, -1) == 0.0)
    allowed = (2.0 * PLACE + np.where(lines, 8e-10, 0.0)) / shorter
    for corner in except_at:
        allowed[np.argmin(np.abs(contour.ends - corner))] = np.pi
    assert np.all(turns <= allowed)


def check_shared_ends(contour: Contour) -> None:
    """Each arc, turned about its centre by its sweep, meets the start of the next piece."""
    turned = contour.centres + (contour.vertices - contour.centres) * np.exp(1j * contour.sweeps)
    arcs = contour.sweeps != 0.0
    # A sweep of half the angle of tangent and chord carries PLACE / chord, times the radius.
    allowed = 8.0 * PLACE * (1.0 + contour.radii / np.maximum(contour.lengths, 1e-6))
    assert np.all((np.abs(turned - contour.ends) <= allowed)[arcs])
