"""Stretches of a contour, cut from its lines and arcs."""

from __future__ import annotations

import cmath

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.sheet.marks import Chain, Layer


def cut_out(contour: Contour, first: float, size: float, layer: Layer) -> Chain:
    """The stretch of the length `size` that begins at the length `first` [mm], below the whole."""
    lengths = contour.lengths
    starts = np.concatenate(([0.0], np.cumsum(lengths)))
    index = min(int(np.searchsorted(starts, first, side="right")) - 1, len(contour) - 1)
    inside = first - float(starts[index])
    vertices, sweeps, left = [], [], size
    while True:
        share = inside / lengths[index] if lengths[index] else 0.0
        taken = min(left, float(lengths[index]) - inside)
        part = taken / float(lengths[index]) if lengths[index] else 0.0
        vertices.append(on(contour, index, share))
        sweeps.append(float(contour.sweeps[index]) * part)
        left -= taken
        if left <= 1e-12 * size:
            vertices.append(on(contour, index, share + part))
            return Chain(np.array(vertices), np.array([*sweeps, 0.0]), layer)
        index, inside = (index + 1) % len(contour), 0.0


def on(contour: Contour, index: int, share: float) -> complex:
    """The point of a piece at a share of its length."""
    start, sweep = complex(contour.vertices[index]), float(contour.sweeps[index])
    if sweep == 0.0:
        return start + share * (complex(contour.ends[index]) - start)
    centre = complex(contour.centres[index])
    return centre + (start - centre) * cmath.exp(1j * sweep * share)
