"""The requests for the segments of a motion plan, before the joints are settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import ALIASES, BALANCES, FAMILIES, LARGEST
from camgeo.kinematics.motion import ENDS, Boundary, End, checked_boundaries
from camgeo.kinematics.plan import FULL_TURN, Dwell, MovingSpan
from camgeo.numeric import checked
from camgeo.record import Pickled

AUTO: Final = "auto"
"""The law name that lets the planner choose."""

CRITERIA: Final = ("velocity", "acceleration", "jerk", "moment")
"""The quantities that `AUTO` can keep small."""

NOTHING: Final[Mapping[str, float]] = MappingProxyType({})

SMALLEST_POSITION: Final = 1e-32
"""Smallest position [mm or rad] other than 0, a scene's 1e-30 degrees; below it, products of
velocities of up to 1e12 strokes exceed what a double can hold."""


def _position(key: str, value: Any) -> float:
    position = checked.finite(key, value)
    if 0.0 < abs(position) < SMALLEST_POSITION:
        raise GeometryError(
            f"must be 0, or at least {SMALLEST_POSITION:g} in magnitude", key, repr(position)
        )
    return position


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
class PositionUnit(checked.CheckedFields):
    """The unit of position in messages.

    Attributes
    ----------
    name : "mm", "inch" or "deg"; empty if unknown.
    size : of one such unit [mm or rad].
    """

    name: str = ""
    size: checked.Positive = 1.0

    def text(self, value: float, order: int = 0) -> str:
        """A position, or its derivative of that order, as text with its unit."""
        number = f"{value / self.size + 0.0:.6g}"
        if not order:
            return f"{number} {self.name}".strip()
        power = "rad" if order == 1 else f"rad^{order}"
        return f"{number} {self.name}/{power}" if self.name else f"{number} per {power}"


@dataclass(frozen=True, slots=True)
class MoveRequest(Pickled, checked.CheckedFields):
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
        place of the parameter inflection; see `camgeo.kinematics.planning.build`. May be empty.
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

    @property
    def stated_parameters(self) -> frozenset[str]:
        """Names of the parameters that the designer decides."""
        return frozenset({*self.parameters, *(("inflection",) if self.balance else ())})


@dataclass(frozen=True, slots=True, eq=False)
class PointsRequest(Pickled):
    """A move through points.

    Attributes
    ----------
    span, to : as for a move.
    shares : (n,) places of the inner points as parts of the span, ascending inside (0, 1).
    positions : (n,) positions at these places [mm or rad], absolute.
    boundaries : s' and s'' [per rad^k] at inner points, by index, None where free.
    velocity, acceleration : at the end of the segment, as for a move.
    """

    span: MovingSpan
    to: Position
    shares: checked.Row
    positions: checked.Row
    boundaries: Mapping[int, Boundary] = field(default_factory=lambda: MappingProxyType({}))
    velocity: checked.Finite | None = None
    acceleration: checked.Finite | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        count = len(self.shares)
        if len(self.positions) != count:
            raise GeometryError(
                f"must be as many as the shares, {count}", "positions", str(len(self.positions))
            )
        boundaries = checked_boundaries("boundaries", self.boundaries, 0, count - 1)
        checked.hold(self, boundaries=MappingProxyType(boundaries))


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
        """Lift from the start of the segment to its end [mm or rad]; 0 over a whole turn, which
        closes whatever the last row says.
        """
        if self.span == FULL_TURN:
            return 0.0
        return float(self.lifts[-1] - self.lifts[0])


Request = Dwell | MoveRequest | PointsRequest | TableRequest


# -- ring -----------------------------------------------------------------------------------------
# The segments of a turn in a ring, with the joints between them, on which planning works. The
# values of the joints are filled in step by step by the modules of this package.


STRAIGHT: Final = "straight-line"

TAKE_JERK: Final = tuple(
    name
    for name, family in FAMILIES.items()
    if any({"j0", "j1"} & {*accepted} for accepted in family.parameters.values())
)
"""Names of the laws that meet a stated jerk."""

FREE_LAWS: Final = (AUTO, "polynomial-5", "polynomial-7", "polynomial")
"""Names of the laws that meet any velocity and acceleration; between two of them the joint is as
smooth as possible."""


@dataclass(slots=True, eq=False)
class RingJoint:
    """A joint of the ring, with the values that are known so far.

    Attributes
    ----------
    position : [mm or rad].
    classes : the classes of motion task that it can still have.
    velocity, acceleration, jerk : s', s'', s''' [per rad^k]; None while unknown.
    stated : names of those that the designer states.
    key : key of the segment that states them, for messages.
    rests : whether the motion rests on one side, or for a moment.
    previous, following : the segments that meet here.
    """

    position: float
    classes: set[End] = field(default_factory=lambda: set(ENDS))
    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    stated: set[str] = field(default_factory=set)
    key: str = ""
    rests: bool = False
    previous: Link = field(init=False, repr=False)
    following: Link = field(init=False, repr=False)

    @property
    def kind(self) -> End:
        """The class of the joint, once only one remains."""
        (only,) = self.classes
        return only

    @property
    def values(self) -> Boundary:
        """Velocity and acceleration."""
        return self.velocity, self.acceleration

    @property
    def settled(self) -> bool:
        """Whether velocity and acceleration are known."""
        return None not in self.values

    @property
    def turns(self) -> bool:
        """Whether the motion turns back here, or does not move on one side."""
        return self.previous.stroke * self.following.stroke <= 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A segment that has a length, between two joints.

    Attributes
    ----------
    number : number of its request, from 0.
    request : what the designer requests for it.
    length : its span [rad].
    start, end : its joints; the same one if it is the only segment.
    stroke : position at its end minus that at its start [mm or rad].
    unit : unit of positions in messages.
    """

    number: int
    request: Request
    length: float
    start: RingJoint
    end: RingJoint
    stroke: float
    unit: PositionUnit

    @property
    def key(self) -> str:
        """Key of the segment in a scene."""
        return f"motion[{self.number + 1}]"

    @property
    def task(self) -> str:
        """The motion task, once the classes of both joints are settled."""
        return f"{self.start.kind}-{self.end.kind}"

    @property
    def rests(self) -> bool:
        return isinstance(self.request, Dwell)

    @property
    def law(self) -> str:
        """The name of the requested law; empty for a segment without a law."""
        return self.request.law if isinstance(self.request, MoveRequest) else ""

    @property
    def move(self) -> MoveRequest:
        """The request of a link that is a move by a law."""
        assert isinstance(self.request, MoveRequest)
        return self.request

    @property
    def is_free(self) -> bool:
        """Whether the segment meets any velocity and acceleration at its ends."""
        return self.law in FREE_LAWS or isinstance(self.request, PointsRequest)

    @property
    def is_named(self) -> bool:
        """Whether its law is named by the designer and has a gentlest reversal.

        This excludes "auto", straight lines, and the polynomials through boundary values, which
        meet any reversal.
        """
        return self.law not in ("", STRAIGHT, *FREE_LAWS)

    @property
    def speed(self) -> float:
        """Mean velocity [mm or rad, per rad]."""
        return self.stroke / self.length

    @property
    def unit_acceleration(self) -> float:
        """s'' [mm or rad, per rad^2] where f'' = 1."""
        return self.stroke / self.length**2
