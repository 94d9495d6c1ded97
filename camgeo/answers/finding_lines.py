"""Findings in words, for text that people read."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from camgeo.answers.answer import BROKEN, FINE, WRONG
from camgeo.check.finding import Finding

MARKS: Final = {
    "invalid": "INVALID",
    "no-disc": "NO DISC",
    "broken": "BROKEN",
    "warning": "warning",
    "ok": "ok",
}

NAME_WIDTH: Final = 26
"""Of the names of findings, at least."""


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """One line per finding, marks and sentences aligned."""
    found = tuple(findings)
    width = max([NAME_WIDTH, *(len(f.name) + 2 for f in found)])
    return [f"{MARKS[f.severity]:8}{f.name:{width}}{f.sentence}" for f in found]


def exit_code(findings: Iterable[Finding]) -> int:
    """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc, else 0."""
    severities = {finding.severity for finding in findings}
    if "invalid" in severities:
        return WRONG
    return BROKEN if severities & {"broken", "no-disc"} else FINE
