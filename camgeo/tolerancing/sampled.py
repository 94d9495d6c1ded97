"""Random machines, each replayed exactly: quantiles of the error, and how many keep the limit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.sweep.family import Sample
from camgeo.tolerancing.contact import ContactForces
from camgeo.tolerancing.freedoms import Deviations
from camgeo.tolerancing.linear import Linear, deviations_of, farther
from camgeo.tolerancing.play import Play
from camgeo.tolerancing.replay import replayed
from camgeo.tolerancing.sources import Source

COUNT: Final = 1024
"""Machines unless another number is stated: the quantiles of 1 % have ten machines beyond them."""

FEWEST: Final = 128
MOST: Final = 16384
"""Their errors take 50 MB."""

QUANTILES: Final = (0.01, 0.5, 0.99)

INSIDE: Final = 2.0**-54
"""Shares are at least this far from 0 and 1, where a normal distribution is infinite."""

BLOCK: Final = 1024
"""Machines of which all motions are held at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """Random machines.

    Attributes
    ----------
    linear : the analysis that they are compared with.
    seed : of what was drawn.
    errors : (machines, n) of the position [mm or rad].
    accelerations : (machines,) largest magnitude of the position's second derivative [mm or rad per
        rad^2] at the cam angles of the analysis.
    acceleration : that of the nominal machine.
    contact : the forces of the nominal machine; None if they are not known.
    forces : (machines, 2) smallest and largest contact force [N] of each; None likewise.
    plays : (machines, 2) least and largest play of each [mm or rad]; None on a single flank.
    """

    linear: Linear
    seed: int
    errors: FloatArray
    accelerations: FloatArray
    acceleration: float
    contact: ContactForces | None
    forces: FloatArray | None
    plays: FloatArray | None

    @property
    def count(self) -> int:
        """Machines."""
        return len(self.errors)

    @property
    def quantiles(self) -> FloatArray:
        """(3, n) errors below which the shares `QUANTILES` of all machines are."""
        found: FloatArray = np.quantile(self.errors, QUANTILES, axis=0)
        return found

    @property
    def worst(self) -> Extreme:
        """The quantile of the largest magnitude."""
        low, _, high = self.quantiles
        return self.linear.largest(farther(high, low))

    @property
    def sigma(self) -> Extreme:
        """The largest standard deviation over the cam angle."""
        return self.linear.largest(np.std(self.errors, axis=0))

    @property
    def largest(self) -> FloatArray:
        """(machines,) magnitudes of the largest error over the turn."""
        return np.asarray(np.max(np.abs(self.errors), axis=1))

    @property
    def kept(self) -> float | None:
        """Share of machines that keep the limit at all cam angles; None if there is no limit."""
        limit = self.linear.stated.limit
        return None if limit is None else float(np.mean(self.largest <= limit))

    @property
    def kept_error(self) -> float | None:
        """Standard error of that share, as if machines were drawn independently.

        By Laplace's rule of succession, so that a sample without failures has one too.
        """
        kept = self.kept
        if kept is None:
            return None
        share = (kept * self.count + 1.0) / (self.count + 2.0)
        return math.sqrt(share * (1.0 - share) / self.count)


def sampled(
    linear: Linear,
    count: int = COUNT,
    seed: int = 0,
    contact: ContactForces | None = None,
    play: Play | None = None,
) -> Sampled:
    """Random machines by a scrambled Sobol sequence; the same seed draws the same ones.

    Parameters
    ----------
    contact : forces of the nominal machine at the angles of the analysis, if they are known.
    play : between the two sides that hold the follower, if there are two.

    Raises
    ------
    GeometryError
        For a count or seed out of range; if a machine has no contact near the nominal one.
    """
    if not FEWEST <= count <= MOST:
        raise GeometryError(f"must be from {FEWEST} to {MOST:,}", "count", str(count))
    if not 0 <= seed < 2**63:
        raise GeometryError("must be a whole number from 0 to 2^63 - 1", "seed", str(seed))
    errors, accelerations, forces, plays = [], [], [], []
    angles = len(linear.angles)
    for machines in _machines(linear.stated.sources, count, seed):
        found = replayed(linear.nominal, machines)
        position = found.position
        if contact is not None:
            off = found.follower - linear.nominal.lifts[:3, np.newaxis]
            normal = contact.of(off[..., :angles], found.leverage[:, :angles])
            forces.append(np.stack((np.min(normal, axis=1), np.max(normal, axis=1)), axis=1))
        if play is not None:
            room = play.at_rest + play.errors(machines)
            plays.append(np.stack((np.min(room, axis=1), np.max(room, axis=1)), axis=1))
        errors.append(linear.as_set(position[0] - linear.nominal.positions[0]))
        accelerations.append(np.max(np.abs(position[2][:, :angles]), axis=1))
    nominal = float(np.max(np.abs(linear.nominal.positions[2][:angles])))
    return Sampled(
        linear,
        seed,
        np.concatenate(errors),
        np.concatenate(accelerations),
        nominal,
        contact,
        np.concatenate(forces) if forces else None,
        np.concatenate(plays) if plays else None,
    )


def _machines(sources: tuple[Source, ...], count: int, seed: int) -> Iterator[Deviations]:
    draws = [each.draws for each in sources]
    shares = Sample(count, "sobol", seed).shares(sum(draws)).T
    shares = np.clip(shares, INSIDE, 1.0 - INSIDE)
    ends = np.cumsum([0, *draws])
    for first in range(0, count, BLOCK):
        numbers = [
            each.numbers(shares[start:end, first : first + BLOCK])
            for each, start, end in zip(sources, ends, ends[1:], strict=False)
        ]
        yield deviations_of(sources, numbers)
