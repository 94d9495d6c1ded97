"""Names of commands, kinds and groups in earlier versions, which the command line still reads."""

from __future__ import annotations

from typing import Final

from camgeo.cli.command import tell

EARLIER: Final = {
    "crank-slide": "slotted-lever",
    "crank-slides": "slotted-levers",
    "crank-slider": "slider-driven-crank",
}


def present_name(name: str) -> str:
    """What is called `name` today; a line on standard error says so if that is another name."""
    present = EARLIER.get(name, name)
    if present != name:
        tell(f'camgeo: "{name}" is called "{present}" now')
    return present
