"""The point nearest to a given one in an intersection of half-planes."""

from __future__ import annotations

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, dot

ROUNDING = 1e-13
"""A point outside a half-plane by this fraction of the size of all of them lies on its border."""


def nearest_point(normals: ComplexArray, bounds: FloatArray, start: complex) -> complex | None:
    """The point P with Re(conj(n) P) >= c for all n, c that is nearest to `start`.

    Parameters
    ----------
    normals : n (k,) complex, not zero.
    bounds : c (k,).

    Returns
    -------
    None if no point lies in all half-planes. It is `start`, its foot on one of the lines, or a
    crossing of two lines; all of these are tried.
    """
    length = np.abs(normals)
    normals, bounds = normals / length, bounds / length
    feet = start + normals * (bounds - dot(normals, start))
    first, second = np.triu_indices(len(normals), 1)
    n1, n2, c1, c2 = normals[first], normals[second], bounds[first], bounds[second]
    area = n1.real * n2.imag - n1.imag * n2.real
    crossing = np.abs(area) > ROUNDING
    area = np.where(crossing, area, 1.0)
    vertices = ((c1 * n2.imag - c2 * n1.imag) + 1j * (c2 * n1.real - c1 * n2.real)) / area
    points = np.concatenate(([start], feet, vertices[crossing]))
    size = np.abs(points) + np.max(np.abs(bounds), initial=0.0)
    inside = np.ones(len(points), dtype=np.bool_)
    for normal, bound in zip(normals, bounds, strict=True):
        inside &= dot(points, normal) >= bound - ROUNDING * size
    if not np.any(inside):
        return None
    found = points[inside]
    return complex(found[np.argmin(np.abs(found - start))])
