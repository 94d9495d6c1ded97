"""What is asked of each segment of a motion plan, before the joints are settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from types import MappingProxyType
from typing import Final

from camgeo.errors import GeometryError
from camgeo.motion.boundary import Boundary, boundaries_of
from camgeo.motion.laws import ALIASES, BALANCES, FAMILIES, LARGEST
from camgeo.motion.spans import FULL_TURN, SHORTEST_SPAN, span_of
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.pickled import Pickled

AUTO: Final = "auto"
"""The law that picks a law."""

CRITERIA: Final = ("velocity", "acceleration", "jerk", "moment")
"""What `AUTO` can be told to keep small."""

NOTHING: Final[Mapping[str, float]] = MappingProxyType({})

SMALLEST_POSITION: Final = 1e-32
"""Smallest position [mm or rad] that is not 0, a scene's 1e-30 degrees; with less, velocities of up
to 1e12 as parts of the stroke are beyond what a double can hold when they are multiplied."""

VALUES: Final = ("velocity", "acceleration", "jerk")


def _checked_end(request: MoveRequest | PointsRequest) -> None:
    """Check what a request tells of its span and its end."""
    to = checked.finite("to", request.to)
    if 0.0 < abs(to) < SMALLEST_POSITION:
        raise GeometryError(
            f"must be 0, or at least {SMALLEST_POSITION:g} in magnitude", "to", repr(to)
        )
    given = {key: getattr(request, key) for key in VALUES if hasattr(request, key)}
    values = {key: checked.optional(key, value) for key, value in given.items()}
    checked.hold(request, span=span_of(request.span, SHORTEST_SPAN), to=to, **values)


@dataclass(frozen=True, slots=True)
class Unit:
    """The unit of position that messages are told in.

    Attributes
    ----------
    name : "mm", "inch" or "deg"; empty where it is not known.
    size : of one such unit [mm or rad].
    """

    name: str = ""
    size: float = 1.0

    def __post_init__(self) -> None:
        checked.hold(self, size=checked.positive("size", self.size))

    def told(self, value: float, order: int = 0) -> str:
        """A position, or its derivative of that order, in words."""
        number = f"{value / self.size + 0.0:.6g}"
        if not order:
            return f"{number} {self.name}".strip()
        power = "rad" if order == 1 else f"rad^{order}"
        return f"{number} {self.name}/{power}" if self.name else f"{number} per {power}"


@dataclass(frozen=True, slots=True)
class Rest:
    """A rest over `span` degrees, exactly as written; one of no length is a moment of rest."""

    span: Decimal

    def __post_init__(self) -> None:
        checked.hold(self, span=span_of(self.span))


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
    balance : the quantity that shall be equally large before and behind the inflection point, in
        place of the parameter inflection; see `camgeo.motion.laws.balance`. Empty for none.
    """

    span: Decimal
    to: float
    law: str
    parameters: Mapping[str, float] = field(default_factory=lambda: NOTHING)
    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    optimise: Mapping[str, float] = field(default_factory=lambda: NOTHING)
    balance: str = ""

    def __post_init__(self) -> None:
        _checked_end(self)
        checked.one_of("law", self.law, (AUTO, *FAMILIES, *ALIASES))
        checked.one_of("balance", self.balance, ("", *BALANCES))
        weights = checked.by_name("optimise", self.optimise)
        for name, weight in weights.items():
            checked.one_of("optimise", name, CRITERIA)
            checked.positive(name, weight)
        parameters = checked.by_name("parameters", self.parameters, LARGEST)
        checked.hold(self, parameters=parameters, optimise=weights)

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

    span: Decimal
    to: float
    shares: FloatArray
    positions: FloatArray
    given: Mapping[int, Boundary] = field(default_factory=lambda: MappingProxyType({}))
    velocity: float | None = None
    acceleration: float | None = None

    def __post_init__(self) -> None:
        _checked_end(self)
        shares, positions = (checked.array(k, getattr(self, k)) for k in ("shares", "positions"))
        if len(shares) != len(positions):
            raise GeometryError(
                f"must be as many as the shares, {len(shares)}", "positions", str(len(positions))
            )
        given = boundaries_of("given", self.given, 0, len(shares) - 1)
        checked.hold(self, shares=shares, positions=positions, given=MappingProxyType(given))


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

    span: Decimal
    shares: FloatArray
    lifts: FloatArray
    smoothing: float | None = None

    def __post_init__(self) -> None:
        shares, lifts = checked.array("shares", self.shares), checked.array("lifts", self.lifts)
        if len(shares) < 2 or len(shares) != len(lifts):
            raise GeometryError(
                f"must be 2 or more, as many as the shares, {len(shares)}", "lifts", str(len(lifts))
            )
        if self.smoothing is not None:
            checked.hold(self, smoothing=checked.positive("smoothing", self.smoothing))
        checked.hold(self, span=span_of(self.span, SHORTEST_SPAN), shares=shares, lifts=lifts)

    @property
    def rise(self) -> float:
        """Way from the start of the segment to its end [mm or rad]; a whole turn closes."""
        if self.span == FULL_TURN:
            return 0.0
        return float(self.lifts[-1] - self.lifts[0])


Request = Rest | MoveRequest | PointsRequest | TableRequest
