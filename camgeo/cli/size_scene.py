"""A scene's text with other sizes of the follower; comments and all else stay."""

from __future__ import annotations

import re
from typing import Final

from camgeo.errors import Fault, SceneError
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller

HEADER: Final = re.compile(r"^[ \t]*\[[ \t]*follower[ \t]*\][^\n]*\n", re.MULTILINE)
NEXT: Final = re.compile(r"^[ \t]*\[\[?[ \t]*[\"'A-Za-z]", re.MULTILINE)


def resized(
    text: str, follower: TranslatingRoller | OscillatingRoller, unit: float, *, arm: bool = False
) -> str:
    """The text with base_radius and offset or pivot of `follower`, and with its `arm` if asked.

    Parameters
    ----------
    text : of a scene that can be read.
    unit : its unit of length [mm].

    Raises
    ------
    SceneError
        If the follower is not written as a table [follower] with a line for each key.
    """
    header = HEADER.search(text)
    if header is None:
        raise _unknown("follower")
    after = NEXT.search(text, header.end())
    end = len(text) if after is None else after.start()
    table = _set(text[header.end() : end], "base_radius", _number(follower.base_radius / unit))
    if isinstance(follower, OscillatingRoller):
        pivot = follower.pivot / unit
        table = _set(table, "pivot", f"[{_number(pivot.real)}, {_number(pivot.imag)}]")
        if arm:
            table = _set(table, "arm", _number(follower.arm / unit))
    else:
        table = _set(table, "offset", _number(follower.offset / unit), beside="base_radius")
    return text[: header.end()] + table + text[end:]


def _set(table: str, key: str, value: str, beside: str = "") -> str:
    """The lines of the table with another value of `key`, added beside another key if missing."""
    pattern = re.compile(rf"^([ \t]*{key}[ \t]*=[ \t]*)(\[[^\]]*\]|[^\s#]+)", re.MULTILINE)
    if pattern.search(table) is not None:
        return pattern.sub(lambda found: found[1] + value, table, count=1)
    line = (
        re.search(rf"^[ \t]*{beside}[ \t]*=[^\n]*(\n|$)", table, re.MULTILINE) if beside else None
    )
    if line is None:
        raise _unknown(f"follower.{key}")
    newline = "\r\n" if line[0].endswith("\r\n") else "\n"
    before = table[: line.end()]
    before += "" if before.endswith("\n") else newline
    return f"{before}{key} = {value}{newline}{table[line.end() :]}"


def _number(value: float) -> str:
    return repr(value + 0.0)


def _unknown(key: str) -> SceneError:
    message = (
        "the scene cannot be written back: it needs a table [follower] with a line for each key"
    )
    return SceneError([Fault(key, "", message)])
