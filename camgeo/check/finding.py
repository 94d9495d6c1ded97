"""A finding: a value of the design compared with a limit, with its place."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from functools import partial
from typing import Annotated, Any, Final, Literal, overload

from camgeo.errors import CamgeoError
from camgeo.kinematics.mechanism.values import Length
from camgeo.numeric.checked import check_fields, number, one_of
from camgeo.record import Displayed, clipped
from camgeo.units import RPM, TURN, LengthUnit, LiftUnit, cam_angle, counted, in_unit, listed

Severity = Literal["ok", "warning", "broken", "no-disc", "invalid"]
"""What a finding means to the designer.

ok: within its limit, or without one, see `Verdict`. warning: worth knowing. broken: beyond its
limit, though the disc can still be made. no-disc: no disc makes this motion, and no outline
is written. invalid: what the scene describes is no cam mechanism, which a command treats as a fault
of the scene.
"""

Verdict = Literal["note", "figure", Severity]
"""How a finding is presented: by its severity if it has a limit, or is bad without one.

figure: a value without a limit, so that it is neither good nor bad. note: a sentence without a
value, which is neither good nor bad either.
"""

FINDINGS: Final = "findings."
"""Prefix of the names under which ledgers record checks."""

NO_OUTLINE: Final = ("invalid", "no-disc")
"""Severities with which no outline is written."""

BROKEN: Final = ("broken", *NO_OUTLINE)
"""Severities of a limit that does not hold."""

UNDERCUT: Final = ("cusp-", "undercut-", "global-undercut-")
"""Beginnings of the names of findings against which a cure can be searched for."""

CONVEXITY: Final = "convexity"
"""Name of the finding against which a cure of a flat face can be searched for."""

RETURN: Final = "return"
"""Marks the return disc: its files are NAME-return, its findings begin with "return: "."""

STATED: Final[dict[LiftUnit, tuple[float, str]]] = {
    "mm": (1.0, "mm"),
    "rad": (math.degrees(1.0), "deg"),
}
"""Factor and unit with which messages state lifts, by the unit of the lift."""


@dataclass(frozen=True, slots=True)
class Finding(Displayed):
    """The result of one check.

    Attributes
    ----------
    name : name of the check, e.g. "transmission-angle".
    severity : see `Severity`.
    sentence : the finding in words, with value, limit and place.
    value : the value found, in `unit`; None if the check has no number.
    limit : the limit that the value is compared with, in `unit`; None if there is none.
    unit : unit of value and limit: "deg", "mm", ... or empty.
    cam_angle : place of the value [rad], given in any turn and stored in [0, 2 pi); None for the
        whole turn.
    cam_range : start and end [rad] of the range over which the limit is broken, the end below the
        start if it passes cam angle 0; None where a single angle says it.
    """

    name: str
    severity: Severity
    sentence: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    cam_angle: float | None = None
    cam_range: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.cam_angle is not None:
            angle = self.cam_angle % TURN
            # The remainder of a negative angle can round up to the whole turn.
            object.__setattr__(self, "cam_angle", angle if angle < TURN else 0.0)

    def in_unit(self, unit: LengthUnit) -> Finding:
        """The finding with the lengths in its sentence in the unit of a scene; value and limit
        remain in `self.unit`.
        """
        figures = (self.value, self.limit) if "mm" in self.unit else ()
        exact = [figure for figure in figures if figure is not None]
        sentence = in_unit(self.sentence, unit, exact)
        return self if sentence == self.sentence else replace(self, sentence=sentence)

    def __repr__(self) -> str:
        return clipped(f"Finding({self.name!r}, {self.verdict!r}, {self.sentence!r})")

    @property
    def verdict(self) -> Verdict:
        """How the finding is presented, see `Verdict`."""
        if self.severity != "ok" or self.limit is not None:
            return self.severity
        return "note" if self.value is None else "figure"


NAMED: Final = 3
"""Most findings of one verdict that are named where many are summarised."""


QUIET: Final = ("ok", "figure", "note")
"""Verdicts of findings that are not bad."""


class Findings(tuple[Finding, ...], Displayed):
    """Several findings, which a notebook shows as a table."""

    __slots__ = ()

    def __repr__(self) -> str:
        names: dict[str, list[str]] = {}
        for finding in self:
            names.setdefault(finding.verdict, []).append(finding.name)
        counts = [
            f"{len(group)} {verdict}" + ("" if verdict in QUIET else f" ({listed(group, NAMED)})")
            for verdict, group in names.items()
        ]
        head = counted(len(self), "finding")
        return clipped(f"<{': '.join([head, *([', '.join(counts)] if counts else [])])}>")


def findings_in_unit(unit: LengthUnit, findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings with their sentences in the unit of a scene, see `Finding.in_unit`."""
    return tuple(findings if unit == "mm" else (finding.in_unit(unit) for finding in findings))


class LazyFindings(Sequence[Finding], Displayed):
    """Findings that are computed when they are first looked at, then shown as `Findings` are.

    Parameters
    ----------
    find : computes the findings; it must return the same object each time.
    """

    def __init__(self, find: Callable[[], Findings]) -> None:
        self._find = find

    @overload
    def __getitem__(self, index: int) -> Finding: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Finding, ...]: ...

    def __getitem__(self, index: int | slice) -> Finding | tuple[Finding, ...]:
        return self._find()[index]

    def __len__(self) -> int:
        return len(self._find())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, tuple | LazyFindings) and self._find() == tuple(other)

    def __hash__(self) -> int:
        return hash(self._find())

    def __repr__(self) -> str:
        try:
            return repr(self._find())
        except CamgeoError as error:
            return clipped(f"<no findings: {error}>")


MOST_ALIKE: Final = 12
"""Most findings of one name and severity that are reported one by one."""

TOUCHING: Final = 1e-9
"""Ranges [rad] this close to each other are reported as one."""


def folded(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings; of more than `MOST_ALIKE` alike only the worst is reported, with all places.

    Findings are alike if they have the same name and severity. The worst is the farthest from its
    limit, or from 0 without a limit; one without a value counts as worst.
    """
    all_findings = tuple(findings)
    alike: dict[tuple[str, str], list[Finding]] = {}
    for finding in all_findings:
        alike.setdefault((finding.name, finding.severity), []).append(finding)
    many = {
        kind: group
        for kind, group in alike.items()
        if len(group) > MOST_ALIKE and all(finding.cam_angle is not None for finding in group)
    }
    reported = []
    for finding in all_findings:
        group = many.get((finding.name, finding.severity), [])
        if not group:
            reported.append(finding)
        elif finding is group[0]:
            worst = max(group, key=_beyond)
            number = counted(len(group), "such finding")
            sentence = f"{worst.sentence}; {number} in all, {_places(group)}"
            reported.append(replace(worst, sentence=sentence, cam_range=None))
    return tuple(reported)


def _beyond(finding: Finding) -> float:
    """By how much the value differs from its limit, or from 0; infinite without a value."""
    if finding.value is None:
        return math.inf
    return abs(finding.value - (finding.limit or 0.0))


def _places(alike: Iterable[Finding]) -> str:
    """The ranges, or places, of several findings in words; ranges that touch are one."""
    ranges: list[tuple[float, float]] = []
    for finding in alike:
        start, end = finding.cam_range or (finding.cam_angle or 0.0, finding.cam_angle or 0.0)
        if ranges and start != end and abs(start - ranges[-1][1]) <= TOUCHING:
            start = ranges.pop()[0]
        ranges.append((start, end))
    places = [" to ".join(dict.fromkeys(map(cam_angle, ends))) for ends in ranges]
    return f"at cam angles {listed(places, MOST_ALIKE)} deg"


def limit_finding(
    name: str,
    statement: str,
    value: float,
    limit: float | None,
    unit: str = "",
    cam_angle: float | None = None,
    *,
    least: bool = False,
) -> Finding:
    """A finding that compares `value` with a `limit` that it must not exceed, or with `least` must
    not fall below. A limit of None reports the value alone. The sentence is `statement` with the
    verdict appended.
    """
    if limit is None:
        return Finding(name, "ok", statement, value, unit=unit, cam_angle=cam_angle)
    broken = value < limit if least else value > limit
    above_or_below, most_or_least = ("below", "at least") if least else ("above", "at most")
    verdict = f"{above_or_below if broken else most_or_least} {limit:g} {unit}".rstrip()
    severity: Severity = "broken" if broken else "ok"
    return Finding(name, severity, f"{statement}, {verdict}", value, limit, unit, cam_angle)


DIGITS: Final = 6
"""Significant digits of a value in a sentence, unless more are needed."""


def rounded_beyond(value: float, digits: int, *, upward: bool, steps: int = 0) -> str:
    """`value` rounded up or down to significant digits, and then moved `steps` units of the last
    digit farther in the same direction.
    """
    exact = Decimal(value)
    if not exact and not steps:
        return "0"
    step = Decimal(1).scaleb((exact.adjusted() if exact else 0) + 1 - digits)
    rounded = exact.quantize(step, rounding=ROUND_CEILING if upward else ROUND_FLOOR)
    return f"{(rounded + (steps if upward else -steps) * step).normalize():f}"


def forbidding(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings among `findings` that rule out the disc."""
    return tuple(finding for finding in findings if finding.severity in NO_OUTLINE)


# -- limits ---------------------------------------------------------------------------------------
# The limits that a design is checked against, with the defaults of the sources.


SLOW = 30.0 * RPM
"""Up to 30 rev/min a mechanism counts as slow (Wirsig, section 2.4)."""

RULE_OF_THUMB: Final = 0.7
"""Largest r_R / r_K of a roller (Wirsig eq. 3.36)."""


def right_angle(key: str, value: Any) -> float:
    """Check that a value is an angle above 0 and at most a right angle [rad]."""
    return number(key, value, above=0.0, most=0.5 * math.pi, unit="radians")


RightAngle = Annotated[float, right_angle]


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a scene; None takes the default, where there is one.

    Attributes
    ----------
    transmission_angle : smallest allowed [rad], up to pi/2.
    linkage_transmission_angle : smallest allowed of the linkage, where it drives its far end [rad],
        up to pi/2.
    radius_ratio : largest allowed r_R / r_K (Wirsig eq. 3.36: r_K >= r_R / 0.7).
    undercut : whether a disc that undercuts is refused, or trimmed to what remains of it.
    closing_error : largest allowed play or squeeze of a conjugate pair whose discs are true to the
        tolerance, as travel of the main roller [mm].
    diameter : largest allowed of a part [mm], of the circle about the cam axis that it sweeps; None
        for no limit.
    mass : largest allowed of a part [t]; None for no limit.
    wall : smallest allowed between two boundaries of a part [mm]; None for what is usual, see
        `camgeo.part.mass`.

    Raises
    ------
    GeometryError
        With the key of an invalid value.
    """

    transmission_angle: RightAngle | None = None
    linkage_transmission_angle: RightAngle | None = None
    radius_ratio: Annotated[float, partial(number, above=0.0, most=1.0)] = RULE_OF_THUMB
    undercut: Annotated[Literal["refuse", "trim"], partial(one_of, choices=("refuse", "trim"))] = (
        "refuse"
    )
    closing_error: Length = 0.02
    diameter: Length | None = None
    mass: Annotated[float, partial(number, above=0.0)] | None = None
    wall: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "limits.")


def is_slow(speed: float | None) -> bool:
    """Whether a mechanism counts as slow at `speed` [rad/s], as it does without a stated speed."""
    return speed is None or speed <= SLOW
