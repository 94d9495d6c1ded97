"""What a writer of one format is, and the writers available.

Writers register as entry points of the group ``camgeo.writers``; the entry point's name is the
format's name on the command line and in the scene, and it loads an object that is a `Writer`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Protocol

from camgeo.check.finding import Finding
from camgeo.errors import Fault, SceneError, meant
from camgeo.formats.format import Format
from camgeo.formats.registry import NO_FORMATS, format_of, writer_entries
from camgeo.product.product import Product


@dataclass(frozen=True, slots=True)
class Written:
    """A file's content and what its writer reports about it.

    Attributes
    ----------
    data : the whole file.
    facts : what the certificate should state besides the deviation, e.g. {"arcs": 64}; numbers and
        short texts, in the order of writing.
    findings : what whoever uses the file has to watch.
    """

    data: bytes
    facts: dict[str, int | float | str] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()


class Writer(Protocol):
    """One file format.

    Attributes
    ----------
    format : its declaration; the name is that of the entry point.

    A writer may also have `companions`, a tuple of writers of the format's further files, each
    with its own suffix, and `pieces`, which gives the products of which it makes a file each where
    one file cannot hold all.
    """

    @property
    def format(self) -> Format[Any]: ...

    def write(self, product: Product, tolerance: float) -> Written:
        """The file; everything in it lies within `tolerance` [mm] of the exact curve.

        Raises ToleranceError if this cannot be met.
        """

    def measure(self, product: Product, data: bytes) -> float | None:
        """Read `data` back and return the proved deviation [mm]; None for pictures."""


def writer_names() -> tuple[str, ...]:
    """Names of all formats that can be written, sorted."""
    return tuple(sorted(writer_entries()))


def with_companions(writer: Writer) -> tuple[Writer, ...]:
    """The writers of all files of a format, `writer` first; their suffixes differ."""
    further: tuple[Writer, ...] = getattr(writer, "companions", ())
    return (writer, *further)


def pieces_of(writer: Writer, product: Product) -> tuple[Product, ...]:
    """The products of which the writer makes a file each, mostly `product` alone."""
    pieces: Callable[[Product], tuple[Product, ...]] | None = getattr(writer, "pieces", None)
    return (product,) if pieces is None else pieces(product)


def find_writer(name: str) -> Writer:
    """Load the writer of format `name`; SceneError if there is none."""
    return find_writers((name,))[name]


def find_writers(names: Iterable[str]) -> dict[str, Writer]:
    """As `find_writer`, for several: what is installed is looked through once."""
    entries = writer_entries()
    found: dict[str, Writer] = {}
    for name in names:
        if name not in entries:
            known = sorted(entries)
            message = f"no writer for this format; there are {', '.join(known)}"
            hint = NO_FORMATS.get(name) or meant(name, known, '"')
            raise SceneError([Fault("format", name, message, hint)])
        found[name] = format_of(entries[name])[0]
    return found
