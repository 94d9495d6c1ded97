"""A finding: a value of the design held against a limit, with its place."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal

Severity = Literal["ok", "warning", "broken", "fatal", "wrong"]
"""ok: within its limit. warning: worth knowing. broken: beyond its limit, the disc can be made all
the same. fatal: there is no such disc, and no outline is written. wrong: what the scene describes
is no cam mechanism; a command treats it as a fault of the scene."""

NO_OUTLINE: Final = ("wrong", "fatal")
"""Severities with which no outline is made."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One check's answer.

    Attributes
    ----------
    name : of the check, e.g. "transmission-angle".
    severity : see `Severity`.
    sentence : the finding in words, with value, limit and place.
    value : what was found, in `unit`; None where the check has no figure.
    limit : what it is held to, in `unit`; None where there is none.
    unit : "deg", "mm", "" ...
    cam_angle : where, [rad] in [0, 2 pi); None for the whole turn.
    cam_range : from, to [rad] where the limit is broken all along, the end below the start if the
        range passes cam angle 0; None where a single angle says it.
    """

    name: str
    severity: Severity
    sentence: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    cam_angle: float | None = None
    cam_range: tuple[float, float] | None = None


def forbidding(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings that say that there is no such disc."""
    return tuple(each for each in findings if each.severity in NO_OUTLINE)
