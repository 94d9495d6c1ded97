"""The writers at hand, by name: entry points of the group ``camgeo.writers``, loaded one by one."""

from __future__ import annotations

import difflib
from importlib.metadata import EntryPoint, entry_points

from camgeo.errors import CamgeoError, Fault, SceneError
from camgeo.files.product import Writer

GROUP = "camgeo.writers"


def writer_names() -> tuple[str, ...]:
    """Names of all formats that can be written, sorted."""
    return tuple(sorted(entry_points(group=GROUP).names))


def with_companions(writer: Writer) -> tuple[Writer, ...]:
    """The writers of all files of a format, `writer` the first; their suffixes differ."""
    further: tuple[Writer, ...] = getattr(writer, "companions", ())
    return (writer, *further)


def find_writer(name: str) -> Writer:
    """Load the writer of format `name`; SceneError if there is none."""
    found: tuple[EntryPoint, ...] = tuple(entry_points(group=GROUP, name=name))
    if not found:
        names = writer_names()
        near = difflib.get_close_matches(name, names, 1)
        hint = f'did you mean "{near[0]}"?' if near else ""
        raise SceneError(
            [
                Fault(
                    "format", name, f"no writer for this format; there are {', '.join(names)}", hint
                )
            ]
        )
    loaded = found[0].load()
    if not isinstance(getattr(loaded, "suffix", None), str):
        raise CamgeoError(f"the entry point {found[0].value} of {GROUP} is no writer")
    writer: Writer = loaded
    return writer
