"""All cures of a cam's undercut."""

from __future__ import annotations

import math

from camgeo.cam.cam import Cam
from camgeo.check.cures.cure import Cure
from camgeo.check.cures.laws import other_law
from camgeo.check.cures.margin import crossings, flanks_of, margin
from camgeo.check.cures.sizes import base_radius, offset_or_arm, roller_radius
from camgeo.check.cures.spans import longer_segment
from camgeo.outline.cusps import CUSP

KNOBS = (base_radius, roller_radius, offset_or_arm, longer_segment, other_law)


def cures(cam: Cam) -> tuple[Cure, ...]:
    """The smallest cure by each knob with all others unchanged, cheapest first.

    Knobs that have no cure come last and say why. Empty if there is nothing to cure, or if there is
    no mechanism.

    Raises
    ------
    GeometryError
        If the flanks are regular and whether they cross cannot be decided.
    """
    least = margin(cam)
    if least is None:
        return ()
    pairs = crossings(flanks_of(cam)) if least > CUSP else ()
    if least > CUSP and not pairs:
        return ()
    found = [knob(cam, pairs) for knob in KNOBS]
    return tuple(sorted(found, key=lambda cure: math.inf if cure.cost is None else cure.cost))
