"""The writers at hand, by name: entry points of the group ``camgeo.writers``, loaded one by one."""

from __future__ import annotations

from camgeo.errors import Fault, SceneError, meant
from camgeo.files.product import Writer
from camgeo.formats.registry import format_of, writer_entries


def writer_names() -> tuple[str, ...]:
    """Names of all formats that can be written, sorted."""
    return tuple(sorted(writer_entries()))


def with_companions(writer: Writer) -> tuple[Writer, ...]:
    """The writers of all files of a format, `writer` the first; their suffixes differ."""
    further: tuple[Writer, ...] = getattr(writer, "companions", ())
    return (writer, *further)


def find_writer(name: str) -> Writer:
    """Load the writer of format `name`; SceneError if there is none."""
    entry = writer_entries().get(name)
    if entry is None:
        names = writer_names()
        message = f"no writer for this format; there are {', '.join(names)}"
        raise SceneError([Fault("format", name, message, meant(name, names, '"'))])
    writer: Writer = format_of(entry)[0]
    return writer
