"""All cures of the undercut of a cam, or of a conjugate pair."""

from __future__ import annotations

import math

from camgeo.check.cures.cure import Cure
from camgeo.check.cures.discs import Discs
from camgeo.check.cures.laws import other_law
from camgeo.check.cures.margin import crossings, margin
from camgeo.check.cures.sizes import base_radius, offset_or_arm, roller_radius
from camgeo.check.cures.spans import longer_segment
from camgeo.outline.cusps import CUSP
from camgeo.units import LengthUnit

SIZES = (base_radius, roller_radius, offset_or_arm)

OF_MOTION = (longer_segment, other_law)


def cures(discs: Discs, unit: LengthUnit = "mm") -> tuple[Cure, ...]:
    """The smallest cure by each knob with all others unchanged, cheapest first.

    It leaves no undercut on any of the discs. Lengths are rounded in `unit`. Knobs that have no
    cure come last and say why. Empty if there is nothing to cure, or if there is no mechanism.

    Raises
    ------
    GeometryError
        If the flanks are regular and whether they cross cannot be decided.
    """
    least = margin(discs)
    if least is None:
        return ()
    pairs = crossings(discs) if least > CUSP else ()
    if least > CUSP and not pairs:
        return ()
    found = [size(discs, unit) for size in SIZES] + [knob(discs, pairs) for knob in OF_MOTION]
    return tuple(sorted(found, key=lambda cure: math.inf if cure.cost is None else cure.cost))
