"""Which lines and arcs a circle meets, and what closed contours enclose, in closed form."""

from __future__ import annotations

import numpy as np

from camgeo.contour.pieces import Pieces
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray


def inside(boundary: Pieces, places: ComplexArray) -> BoolArray:
    """(k,) whether `places` (k,) lie within an odd number of the closed contours of `boundary`."""
    q = places[:, None]
    start, end = boundary.starts - q, boundary.ends - q
    up = start.imag <= 0.0
    crosses = up != (end.imag <= 0.0)
    along = boundary.ends - boundary.starts
    side = start.real * end.imag - start.imag * end.real  # > 0 where q lies left of the chord
    # On the chord itself as if q lay a little higher, as for the ends of the chord.
    side = np.where(side != 0.0, side, np.where(along.real != 0.0, along.real, -along.imag))
    odd = crosses & (np.where(up, side, -side) > 0.0)
    arcs = boundary.sweeps != 0.0
    if np.any(arcs):
        # Between chord and arc the arc has q on the other side.
        within = np.abs(q - boundary.centres) < np.abs(boundary.starts - boundary.centres)
        beyond = side * np.sign(boundary.sweeps) < 0.0
        odd ^= arcs & within & beyond
    found: BoolArray = np.sum(odd, axis=1) % 2 == 1
    return found


def crossings(pieces: Pieces, place: complex, radius: float, distance: float) -> FloatArray:
    """(m,) angles [rad] at which the circle around `place` may meet what is `distance` away.

    All angles at which the distance of a point of the circle from the pieces passes `distance` are
    among them; others are too.
    """
    arcs = pieces.sweeps != 0.0
    found = []
    lines = ~arcs & (pieces.starts != pieces.ends)
    if np.any(lines):
        along = pieces.ends[lines] - pieces.starts[lines]
        normal = 1j * along / np.abs(along)
        height = np.real((pieces.starts[lines] - place) * np.conj(normal))
        for side in (-distance, distance):
            found += _pairs(np.angle(normal), (height + side) / radius)
    circles: list[tuple[ComplexArray, FloatArray]] = []
    if distance > 0.0:
        both = np.concatenate((pieces.starts, pieces.ends))
        circles.append((both, np.full(len(both), distance)))
    if np.any(arcs):
        arms = np.abs(pieces.starts[arcs] - pieces.centres[arcs])
        for side in (-distance, distance):
            circles.append((pieces.centres[arcs], np.abs(arms + side)))
    for centres, radii in circles:
        away = np.abs(centres - place)
        cosine = (away**2 + radius**2 - radii**2) / np.where(
            away > 0.0, 2.0 * away * radius, np.nan
        )
        found += _pairs(np.angle(centres - place), cosine)
    return np.concatenate(found) if found else np.zeros(0)


def _pairs(middle: FloatArray, cosine: FloatArray) -> list[FloatArray]:
    """Both angles around `middle` with that cosine, where there are any."""
    real = np.abs(cosine) <= 1.0
    half = np.arccos(cosine[real])
    return [middle[real] - half, middle[real] + half]
