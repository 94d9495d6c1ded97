"""Straight line (Gerade), VDI 2143-1 eqs. (21) to (23): constant velocity, a shock at both ends.

As a segment between others it determines the velocity at the ends of its neighbours.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

import numpy as np

from camgeo.kinematics.laws.family import Family, LawParameters, inflection_point
from camgeo.kinematics.laws.law import Boundary, Law, Region, Values
from camgeo.numeric.arrays import FloatArray


def _from_start(z: FloatArray, _w: FloatArray, _: Any) -> Values:
    zero = np.zeros_like(z)
    return np.array((z, np.ones_like(z), zero, zero))


def _from_end(z: FloatArray, w: FloatArray, _: Any) -> Values:
    return _from_start(w, z, _)


def _make(task: str, parameters: LawParameters) -> Law:
    inflection_point(
        task, parameters.get("inflection", 0.5)
    )  # a straight line has no inflection to shift
    return Law(
        name="straight-line",
        task=task,
        regions=(
            Region(0.0, 0.5, _from_start, lambda _z, w: w.copy(), 0.0, from_end=False),
            Region(0.5, 1.0, _from_end, lambda z, _w: z.copy(), 0.0, from_end=True),
        ),
        borders=(),
        start=Boundary(velocity=1.0),
        end=Boundary(velocity=1.0),
        parameters=MappingProxyType(dict(parameters)),
    )


FAMILY = Family("straight-line", {"R-R": ("inflection",), "G-G": ()}, _make)
