"""The requests for the segments of a motion plan, before the joints are settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.motion.boundary import Boundary, boundaries_of
from camgeo.motion.laws import ALIASES, BALANCES, FAMILIES, LARGEST
from camgeo.motion.plan import Dwell
from camgeo.motion.spans import FULL_TURN, MovingSpan
from camgeo.numeric import checked
from camgeo.pickled import Pickled

AUTO: Final = "auto"
"""The law name that lets the planner choose."""

CRITERIA: Final = ("velocity", "acceleration", "jerk", "moment")
"""The quantities that `AUTO` can keep small."""

NOTHING: Final[Mapping[str, float]] = MappingProxyType({})

SMALLEST_POSITION: Final = 1e-32
"""Smallest position [mm or rad] other than 0, a scene's 1e-30 degrees; below it, products of
velocities of up to 1e12 strokes exceed what a double can hold."""


def _position(key: str, value: Any) -> float:
    found = checked.finite(key, value)
    if 0.0 < abs(found) < SMALLEST_POSITION:
        raise GeometryError(
            f"must be 0, or at least {SMALLEST_POSITION:g} in magnitude", key, repr(found)
        )
    return found


def _weights(key: str, value: Any) -> Mapping[str, float]:
    weights = checked.by_name(key, value)
    for name, weight in weights.items():
        checked.one_of(key, name, CRITERIA)
        checked.positive(name, weight)
    return weights


Position = Annotated[float, _position]
Weights = Annotated[Mapping[str, float], _weights]
Parameters = Annotated[Mapping[str, float], partial(checked.by_name, largest=LARGEST)]
LawName = Annotated[str, partial(checked.one_of, choices=(AUTO, *FAMILIES, *ALIASES))]
Balance = Annotated[str, partial(checked.one_of, choices=("", *BALANCES))]


@dataclass(frozen=True, slots=True)
class Unit:
    """The unit of position in messages.

    Attributes
    ----------
    name : "mm", "inch" or "deg"; empty if unknown.
    size : of one such unit [mm or rad].
    """

    name: str = ""
    size: checked.Positive = 1.0

    def __post_init__(self) -> None:
        checked.check_fields(self)

    def text(self, value: float, order: int = 0) -> str:
        """A position, or its derivative of that order, as text with its unit."""
        number = f"{value / self.size + 0.0:.6g}"
        if not order:
            return f"{number} {self.name}".strip()
        power = "rad" if order == 1 else f"rad^{order}"
        return f"{number} {self.name}/{power}" if self.name else f"{number} per {power}"


@dataclass(frozen=True, slots=True)
class MoveRequest(Pickled):
    """A move by a law.

    Attributes
    ----------
    span : degrees, exactly as written.
    to : position at the end [mm or rad].
    law : name of a family, an alias, or `AUTO`.
    parameters : of the law, normalised, without boundary values: inflection, curved, sine, cosine.
    velocity, acceleration, jerk : s', s'', s''' at the end of the move, with respect to the cam
        angle [per rad^k]; None where they follow from the neighbours.
    optimise : weights of `CRITERIA`, for `AUTO`.
    balance : the quantity that must be equally large before and after the inflection point, in
        place of the parameter inflection; see `camgeo.motion.laws.balance`. May be empty.
    """

    span: MovingSpan
    to: Position
    law: LawName
    parameters: Parameters = field(default_factory=lambda: NOTHING)
    velocity: checked.Finite | None = None
    acceleration: checked.Finite | None = None
    jerk: checked.Finite | None = None
    optimise: Weights = field(default_factory=lambda: NOTHING)
    balance: Balance = ""

    def __post_init__(self) -> None:
        checked.check_fields(self)

    @property
    def shaped_by(self) -> frozenset[str]:
        """Names of the parameters that the designer decides."""
        return frozenset({*self.parameters, *(("inflection",) if self.balance else ())})


@dataclass(frozen=True, slots=True, eq=False)
class PointsRequest(Pickled):
    """A move through points.

    Attributes
    ----------
    span, to : as of a move.
    shares : (n,) places of the inner points as parts of the span, ascending inside (0, 1).
    positions : (n,) there [mm or rad], absolute.
    given : s' and s'' [per rad^k] at inner points, by index, None where free.
    velocity, acceleration : at the end of the segment, as of a move.
    """

    span: MovingSpan
    to: Position
    shares: checked.Row
    positions: checked.Row
    given: Mapping[int, Boundary] = field(default_factory=lambda: MappingProxyType({}))
    velocity: checked.Finite | None = None
    acceleration: checked.Finite | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        count = len(self.shares)
        if len(self.positions) != count:
            raise GeometryError(
                f"must be as many as the shares, {count}", "positions", str(len(self.positions))
            )
        given = boundaries_of("given", self.given, 0, count - 1)
        checked.hold(self, given=MappingProxyType(given))


@dataclass(frozen=True, slots=True, eq=False)
class TableRequest(Pickled):
    """A move by a lift table.

    Attributes
    ----------
    span : degrees, exactly as written.
    shares : (n,) places of the rows as parts of the span, from 0 to 1.
    lifts : (n,) [mm or rad]; the first row is where the segment starts.
    smoothing : largest allowed deviation from the rows [mm or rad]; None interpolates.
    """

    span: MovingSpan
    shares: checked.Row
    lifts: checked.Row
    smoothing: checked.Positive | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        count = len(self.shares)
        if count < 2 or count != len(self.lifts):
            raise GeometryError(
                f"must be 2 or more, as many as the shares, {count}", "lifts", str(len(self.lifts))
            )

    @property
    def rise(self) -> float:
        """Lift from the start of the segment to its end [mm or rad]; a whole turn closes."""
        if self.span == FULL_TURN:
            return 0.0
        return float(self.lifts[-1] - self.lifts[0])


Request = Dwell | MoveRequest | PointsRequest | TableRequest
