"""What a command finds: a frozen result, with text, JSON, tables and pictures as renderings.

Each command has a package in this stage: its result, a dataclass that is an `Answer`, and the
function that makes it; `rendering`, which has `text` and perhaps `table` and `figure`, functions of
the result alone; and schema.json, the JSON Schema of its document, by which the
document is read from the result (`camgeo.answers.render`).
"""

from __future__ import annotations

from typing import ClassVar, Final

FINE: Final = 0
BROKEN: Final = 1
WRONG: Final = 2
"""Exit codes: all limits kept; a limit is broken; the scene or the call is wrong."""


class Answer:
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
