"""Area and first moments of the region inside a contour of lines and arcs, in closed form."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.outline.moments import Moments, piece_moments


def contour_moments(contour: Contour) -> Moments:
    """Moments of the region inside `contour`, see `camgeo.outline.moments.piece_moments`.

    They are taken about the middle of its vertices and moved from there, so that a small contour
    far from the origin keeps its digits.
    """
    middle = complex(np.mean(contour.vertices))
    about = piece_moments(
        contour.vertices - middle, contour.ends - middle, contour.sweeps, contour.centres - middle
    )
    return Moments(
        about.area,
        about.first + about.area * middle,
        about.area_error,
        about.first_error + about.area_error * abs(middle),
    )
