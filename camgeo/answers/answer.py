"""What a command finds: a frozen result, with text, JSON, tables and pictures as renderings.

Each command has a package in this stage: its result, a dataclass that is an `Answer`, and the
function that makes it; `rendering`, which has `text` and perhaps `table` and `figure`, functions of
the result alone; and schema.json, the JSON Schema of its document, by which the
document is read from the result (`camgeo.answers.render`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar, Final

from camgeo.displayed import Displayed
from camgeo.wording import counted

if TYPE_CHECKING:  # the command line needs the exit codes before it imports anything else
    from camgeo.check.finding import Finding

FINE: Final = 0
BROKEN: Final = 1
WRONG: Final = 2
CRASHED: Final = 70
"""Exit codes: all limits kept; a limit is broken; the scene or the call is wrong; an error in
camgeo itself, EX_SOFTWARE of BSD's sysexits.h."""

STOPPED: Final = 128
"""Exit code after a signal, less its number: 130 after Ctrl-C, as shells count it."""


class Answer(Displayed):
    """Base of the results, which are frozen dataclasses; lengths in mm, angles in rad.

    Attributes
    ----------
    command : that it answers, as on the command line.
    version : of its JSON document; incremented when a key is removed or changes its meaning.
    """

    __slots__ = ()

    command: ClassVar[str]
    version: ClassVar[int] = 1

    @property
    def exit_code(self) -> int:
        """How the command ends."""
        return FINE


MARKS: Final = {
    "invalid": "INVALID",
    "no-disc": "NO DISC",
    "broken": "BROKEN",
    "warning": "warning",
    "ok": "ok",
    "figure": "figure",
    "note": "note",
}
"""Words for what is said of findings, by their verdict."""

MANY: Final = {**MARKS, "warning": "warnings", "figure": "figures", "note": "notes"}
"""The same of several findings."""

NAME_WIDTH: Final = 26
"""Of the names of findings, at least."""


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """One line per finding, marks and sentences aligned."""
    found = tuple(findings)
    width = max([NAME_WIDTH, *(len(f.name) + 2 for f in found)])
    return [f"{MARKS[f.verdict]:8}{f.name:{width}}{f.sentence}" for f in found]


def verdict_on(findings: Iterable[Finding]) -> str:
    """How many findings there are, and how many of each severity that is not "ok"."""
    several = Counter[str](each.severity for each in findings)
    bad = [
        counted(several[each], MARKS[each], MANY[each])
        for each in MARKS
        if several[each] and each != "ok"
    ]
    return f"{counted(several.total(), 'finding')}: {', '.join(bad) or 'all limits are kept'}"


def exit_code(findings: Iterable[Finding]) -> int:
    """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc, else 0."""
    severities = {finding.severity for finding in findings}
    if "invalid" in severities:
        return WRONG
    return BROKEN if severities & {"broken", "no-disc"} else FINE
