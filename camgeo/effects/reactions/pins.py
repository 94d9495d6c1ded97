"""Reactions in the joints of a linkage, see `camgeo.effects.coupler`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from camgeo.effects.coupler import Coupler, Joints
from camgeo.effects.force import at_rates, rates_of
from camgeo.effects.reactions.load import Load
from camgeo.numeric.arrays import FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity


@dataclass(frozen=True, slots=True, eq=False)
class Pins:
    """The joints at the speed of the scene."""

    coupler: Coupler

    def at(self, phi: FloatArray, side: Side) -> Joints:
        """The forces (n,) at n cam angles [rad]."""
        rates, found = rates_of(self.coupler.subject, phi, side), self.coupler.joints(phi, side)
        return Joints(*(at_rates(each, rates) for each in (found.near, found.far, found.held)))

    def loads(self) -> list[Load]:
        """What is reported of them."""
        linkage = self.coupler.linkage
        follower = self.coupler.subject.cam.follower.mover
        words = f"force between coupler and {linkage.member}"
        found = [
            Load("near pin force", f"force between {follower} and coupler", self._size("near")),
            Load("far pin force", words, self._size("far")),
        ]
        if linkage.unit == "mm":
            words = "force across the guide of the slider"
            found.append(Load("slider guide force", words, self._size("held")))
        return found

    def _size(self, joint: Literal["near", "far", "held"]) -> Quantity:
        return lambda phi, side: np.abs(getattr(self.at(phi, side), joint))
