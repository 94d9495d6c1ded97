"""What is solved for to find how the cam turns, and how an elastic train acts back on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from camgeo.effects.effect import Bound
from camgeo.effects.wording import Label
from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Feedback:
    """The last of the rounds in which an elastic train and how the cam turns are computed for each
    other.

    Attributes
    ----------
    rounds : their number.
    residual : the largest difference of the speed that it finds from the one that the train is
        computed for [rad/s].
    ratio : what is left of a change after a round, as estimated from the last ones.
    """

    rounds: int
    residual: float
    ratio: float


@dataclass(frozen=True, slots=True, eq=False)
class Sought:
    """A quantity over the cam angle that an equation of motion is solved for.

    Attributes
    ----------
    label : how it is displayed.
    values : (n,) at n cam angles [rad].
    bound : its error.
    """

    label: Label
    values: Callable[[FloatArray], FloatArray]
    bound: Bound
