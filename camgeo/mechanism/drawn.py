"""What the sketches of followers have in common."""

from __future__ import annotations

import cmath

import numpy as np

from camgeo.mechanism.follower import Follower
from camgeo.mechanism.sketch import Guide, MechanismSketch

GUIDE = 0.8
"""Way from a carriage at its farthest to its guide, in base radii."""

ROD = 0.3
"""By so much the rod of a carriage stands out of its guide at lift 0, in base radii."""

BRACKET = 1.2
"""Way round the discs from the one roller of a carriage to the other, in their largest radii."""


def traced_point(follower: Follower, lift: float) -> complex:
    """The roller centre, or the contact of a flat face that rests, in the fixed frame [mm]."""
    at = follower.relative_jet(np.array([[lift], [0.0], [0.0], [0.0]]), 1, 1)
    return complex(at.along[0, 0], at.across[0, 0]) * cmath.exp(1j * at.axis)


def carriage(
    follower: Follower, out: complex, lift: float, farthest: float
) -> tuple[complex, MechanismSketch]:
    """Where a carriage touches at `lift` [mm], and its rod in its guide, which points `out`."""
    held, start, here = (traced_point(follower, at) for at in (farthest, 0.0, lift))
    middle = held + GUIDE * follower.base_radius * out
    end = middle + here - start + ROD * follower.base_radius * out
    rod = MechanismSketch(links=((here, end),), guides=(Guide(middle, out, block=False),))
    return here, rod


def bracket(first: complex, second: complex, reach: float) -> tuple[complex, ...]:
    """From one side of the cam to the other, clear of a disc of the radius `reach`."""
    aside = 1j * (first - second) / abs(first - second) * BRACKET * reach
    return first, first + aside, second + aside, second


def across(here: complex, breadth: float) -> tuple[complex, MechanismSketch]:
    """The far side of a yoke whose near one is at `here` [mm], and what joins both."""
    there = here - breadth * here / abs(here)
    return there, MechanismSketch(links=(bracket(here, there, 0.6 * breadth),))
