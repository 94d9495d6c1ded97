"""What a drawing shows when it is opened: its extents, its limits and the view of the model space.

Most programs open a drawing in the view that it states, wherever its entities lie.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ezdxf.layouts.layout import Modelspace

from camgeo.contour.contour import Contour
from camgeo.contour.spline import SplineContour
from camgeo.numeric.arrays import ComplexArray, FloatArray

MARGIN = 0.05
"""Of the view, on each side, as a fraction of the larger side of the drawing."""

ASPECT = 4.0 / 3.0
"""Width of the view over its height. The view is as high as the drawing is wide, so a window of any
shape shows the whole drawing."""

ACTIVE = "*Active"
"""Name of the view that is open."""


def show(space: Modelspace, contours: Sequence[Contour | SplineContour], scale: float) -> None:
    """Fit extents, limits and view to what is drawn: `contours` [mm], at `scale` mm per unit."""
    points = np.concatenate([_extremes(contour) for contour in contours]) / scale
    low = complex(points.real.min(), points.imag.min())
    high = complex(points.real.max(), points.imag.max())
    size = max((high - low).real, (high - low).imag)
    margin = MARGIN * size * (1.0 + 1.0j)
    space.reset_extents((low.real, low.imag, 0.0), (high.real, high.imag, 0.0))
    least, most = low - margin, high + margin
    space.reset_limits((least.real, least.imag), (most.real, most.imag))
    middle = 0.5 * (low + high)
    (view,) = space.doc.viewports.get_config(ACTIVE)
    view.dxf.center = (middle.real, middle.imag)
    view.dxf.height = (1.0 + 2.0 * MARGIN) * size
    view.dxf.aspect_ratio = ASPECT


def _extremes(contour: Contour | SplineContour) -> ComplexArray:
    """(n,) complex [mm] points on the contour, the outermost ones along both axes among them."""
    if isinstance(contour, Contour):
        return _of_pieces(contour.vertices, contour.sweeps, contour.centres)
    rows = [(arc.start, arc.sweep, arc.centre) for arc in contour.arcs]
    starts, sweeps, centres = np.array(rows, dtype=np.complex128).reshape(-1, 3).T
    splines = [_of_cubics(spline.beziers) for spline in contour.splines]
    return np.concatenate((_of_pieces(starts, sweeps.real, centres), *splines))


def _of_pieces(starts: ComplexArray, sweeps: FloatArray, centres: ComplexArray) -> ComplexArray:
    """The starts, and where arcs run along an axis."""
    bent = sweeps != 0.0
    starts_of, centres, sweeps = starts[bent], centres[bent], sweeps[bent]
    arm = starts_of - centres
    found = [starts]
    for direction in (1.0, 1.0j, -1.0, -1.0j):
        turned = np.angle(direction / arm) * np.sign(sweeps) % (2.0 * np.pi)
        reached = turned <= np.abs(sweeps)
        found.append((centres + np.abs(arm) * direction)[reached])
    return np.concatenate(found)


def _of_cubics(pieces: ComplexArray) -> ComplexArray:
    """The ends of (n, 4) Bezier pieces, and where they run along an axis."""
    found = [pieces[:, 0], pieces[:, 3]]
    for values in (pieces.real, pieces.imag):
        a, b, c = np.diff(values, axis=1).T
        # The derivative is a (1 - t)^2 + 2 b t (1 - t) + c t^2.
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        for bottom in (a - b + root, a - b - root):
            share = np.where(bottom == 0.0, 0.0, a) / np.where(bottom == 0.0, 1.0, bottom)
            share = np.clip(share, 0.0, 1.0)[:, None]
            level = pieces
            while level.shape[1] > 1:  # de Casteljau's algorithm
                level = (1.0 - share) * level[:, :-1] + share * level[:, 1:]
            found.append(level[:, 0])
    return np.concatenate(found)
