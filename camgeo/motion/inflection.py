"""Shift of the inflection point: an asymmetric law from a symmetric one (VDI 2143-1, 6.1.2).

With lambda the z of the inflection point, eqs. (66) to (75): the accelerating half runs stretched
over [0, lambda], the decelerating one over [lambda, 1]; f' keeps its values, f'' and f''' scale
with the stretching. f'' stays continuous at lambda wherever the base law has f''(1/2) = 0.
"""

from __future__ import annotations

from camgeo.motion.laws import law_of
from camgeo.motion.laws.law import Law


def shift(law: Law, inflection: float) -> Law:
    """Return `law` with its inflection point at lambda = `inflection`, 0 < lambda < 1.

    Raises GeometryError if lambda is not inside (0, 1) or the law has none.
    """
    return law_of(law.name, law.task, {**law.parameters, "inflection": inflection})
