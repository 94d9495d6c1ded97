"""The known formats, by name; each is imported only when it is requested."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Final

from camgeo.errors import CamgeoError, UnknownNameError
from camgeo.formats.format import Format

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP: Final = "camgeo.writers"
"""Entry points of the writers of all formats; the name is the format's."""

FORMATS: Final = {
    "dxf": "dxf:FORMAT",
    "gcode": "gcode:FORMAT",
    "stl": "plain:STL",
    "3mf": "threemf:FORMAT",
    "step": "step:FORMAT",
    "csv": "csv:FORMAT",
    "cut-svg": "plain:CUT_SVG",
    "svg": "plain:SVG",
    "png": "plain:PNG",
    "asc": "plain:ASC",
    "drawing": "drawing:FORMAT",
}
"""Formats of camgeo, each with its module and its name there."""

NO_FORMATS: Final = {
    "pdf": "PDFs are drawn by: camgeo plot SCENE -o FILE.pdf; a sheet by the format drawing",
}
"""Names that users may take for formats, with hints at what makes such files."""


def find_format(name: str) -> Format[Any]:
    """The format `name`; its module, or that of a foreign writer, is imported now.

    Raises
    ------
    UnknownNameError
        If there is none.
    CamgeoError
        If another distribution registers something else than a writer under this name.
    """
    if name in FORMATS:
        module, _, constant = FORMATS[name].partition(":")
        own: Format[Any] = getattr(importlib.import_module(f"camgeo.formats.{module}"), constant)
        return own
    entry = writer_entries().get(name)
    if entry is None:
        raise UnknownNameError("format", name, (*FORMATS, *foreign_names()))
    return format_of(entry)[1]


def format_of(entry: EntryPoint) -> tuple[Any, Format[Any]]:
    """The writer behind an entry point, loaded now, and its format; raises CamgeoError."""
    try:
        writer = entry.load()
    except Exception as error:  # whatever another distribution does wrong
        message = f"the entry point {entry.value} of {GROUP} cannot be loaded: {error}"
        raise CamgeoError(message) from error
    found: Any = getattr(writer, "format", None)
    if not isinstance(found, Format) or found.name != entry.name:
        message = (
            f"the entry point {entry.value} of {GROUP} is not a writer of format {entry.name!r}"
        )
        raise CamgeoError(message)
    return writer, found


def foreign_names() -> tuple[str, ...]:
    """Names of the formats of other distributions, sorted."""
    return tuple(sorted(writer_entries().keys() - set(FORMATS)))


def writer_entries() -> dict[str, EntryPoint]:
    """The entry points of all writers, by the names of their formats."""
    from importlib.metadata import entry_points  # a check needs none

    return {each.name: each for each in entry_points(group=GROUP)}
