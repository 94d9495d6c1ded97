"""Independent measures of spline contours: scipy's B-splines, dense points, tangents at joints."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline

from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.numeric.arrays import ComplexArray, FloatArray

EACH = 60
"""Points a cubic."""


def curve_of(spline: CubicSpline) -> BSpline:
    """The same as scipy's."""
    return BSpline(spline.knots, spline.controls, 3)


def parameters(spline: CubicSpline, each: int = EACH) -> FloatArray:
    """Dense parameters, the ends of all spans among them."""
    places = np.unique(spline.knots)
    part = np.arange(each) / each
    inner = (places[:-1, None] + np.diff(places)[:, None] * part).ravel()
    return np.append(inner, places[-1])


def points_of(strand: CubicSpline | Arc, each: int = EACH) -> ComplexArray:
    """Dense points, both ends included."""
    if isinstance(strand, CubicSpline):
        found: ComplexArray = curve_of(strand)(parameters(strand, each))
        return found
    part = np.linspace(0.0, 1.0, min(20 * each, 40_000))
    if strand.sweep:
        turned = np.exp(1j * strand.sweep * part)
        return np.asarray(strand.centre + (strand.start - strand.centre) * turned)
    return np.asarray(strand.start + (strand.end - strand.start) * part)


def dense(contour: SplineContour, each: int = EACH) -> ComplexArray:
    """Dense points of the whole contour."""
    return np.concatenate([points_of(strand, each)[:-1] for strand in contour.strands])


def tangents(strand: CubicSpline | Arc) -> tuple[complex, complex]:
    """Unit tangents at both ends."""
    if isinstance(strand, CubicSpline):
        slope = curve_of(strand).derivative()
        first, last = complex(slope(strand.knots[0])), complex(slope(strand.knots[-1]))
    elif strand.sweep:
        sense = 1j * np.sign(strand.sweep)
        first, last = (sense * (end - strand.centre) for end in (strand.start, strand.end))
    else:
        first = last = strand.end - strand.start
    return first / abs(first), last / abs(last)
