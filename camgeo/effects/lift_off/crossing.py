"""Where the roller of a groove changes flanks, or the follower of a pair its disc."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.ranges import runs
from camgeo.effects.results import ContactForce


@dataclass(frozen=True, slots=True)
class Change:
    """The roller leaves one flank for the other.

    Attributes
    ----------
    leaving : cam angle [rad] in [0, 2 pi) up to which the first flank carries.
    carrying : from which the other one does; the same unless there is a range without force.
    sense : of the flank left behind, +1 for the inner one, -1 for the outer one.
    """

    leaving: float
    carrying: float
    sense: int


def flank_changes(contact: ContactForce) -> tuple[int, tuple[Change, ...]]:
    """The flank that carries first, 0 if none does, and the changes over a turn.

    `contact.edges` has all angles at which the force changes sign. Ranges without force belong to
    no flank.
    """
    edges = contact.edges
    sign = np.sign(contact.normal(0.5 * (edges[:-1] + edges[1:]), "right")).astype(int)
    both = [(pieces, sense) for sense in (1, -1) for pieces in runs(sign == sense)]
    if not both:
        return 0, ()
    both.sort(key=lambda each: each[0][0])
    found = []
    for (pieces, sense), (others, other) in zip(both, both[1:] + both[:1], strict=True):
        if sense != other:
            leaving, carrying = edges[pieces[-1] + 1], edges[others[0]]
            found.append(Change(float(leaving % edges[-1]), float(carrying), sense))
    found.sort(key=lambda change: change.leaving)
    return both[0][1], tuple(found)
