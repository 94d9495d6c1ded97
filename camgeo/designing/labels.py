"""Names of keys of a scene, and short names of changes, for undo."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from typing import Any, Final

from camgeo.scene.document import written
from camgeo.scene.keys import Path, path_of

NAMED: Final = 2
"""Most values that a label names; the rest is counted."""

DIGITS: Final = 6
"""Significant digits of a number in a label."""

LONGEST: Final = 80
"""Characters of a label."""


def title_of(path: Path) -> str:
    """What a key is called: "roller radius" for follower.roller_radius."""
    words = [str(step) for step in path if isinstance(step, str)]
    if not words:
        return ""
    number = f" {path[-1] + 1}" if isinstance(path[-1], int) else ""
    return words[-1].replace("_", " ").replace("-", " ") + number


def label_of(edits: Mapping[str, Any], units: Mapping[str, str]) -> str:
    """The name of the change that sets these values, with the units of their keys."""
    named = [_named(key, value, units.get(key, "")) for key, value in edits.items()]
    rest = len(named) - NAMED
    label = ", ".join(named[:NAMED]) + (f" and {rest} more" if rest > 0 else "")
    return label if len(label) <= LONGEST else f"{label[:LONGEST]}..."


def _named(key: str, value: Any, unit: str) -> str:
    path = path_of(key) or ()
    title = title_of(path)
    if path[:1] == ("motion",) and len(path) > 1 and isinstance(path[1], int):
        title = f"segment {path[1] + 1} {title}"
    if value is None:
        return f"{title} removed"
    gap = "" if unit == "°" else " "
    return f"{title} {shown(value)}{gap}{unit}".rstrip()


def shown(value: Any) -> str:
    """A value in a label: numbers with few digits, texts without quotes."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, int | float | Decimal):
        return f"{float(value):.{DIGITS}g}"
    if isinstance(value, list | tuple):
        rest = ", ..." if len(value) > NAMED else ""
        return f"[{', '.join(map(shown, value[:NAMED]))}{rest}]"
    return value if isinstance(value, str) else written(value)
