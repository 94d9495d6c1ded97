"""What a writer gets to see of a design, and what a writer is.

Writers register as entry points of the group ``camgeo.writers``; the entry point's name is the
format's name on the command line and in the scene, and it loads an object that is a `Writer`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from camgeo.check.finding import Finding
from camgeo.formats.format import Format, Options, Values
from camgeo.lazy import Ledger
from camgeo.units import LengthUnit

if TYPE_CHECKING:  # a writer is computed the views that it reads, and no other
    from camgeo.files.drawn import DrawnDisc
    from camgeo.files.milled import MilledDisc
    from camgeo.files.pictured import PicturedCam
    from camgeo.files.tabulated import TabulatedCam


class Product(Protocol):
    """A disc as its writers see it: what all of them share, and a view for each reader.

    `camgeo.workpiece.Workpiece` is one.
    """

    @property
    def name(self) -> str:
        """Name of the disc; the stem of its files."""

    @property
    def unit(self) -> LengthUnit:
        """Unit of length of the scene; drawings, programs and tables are written in it."""

    @property
    def scene_hash(self) -> str:
        """SHA-256 of all that the scene says of files, hexadecimal."""

    @property
    def scene_files(self) -> dict[str, str]:
        """SHA-256 of the files that the scene reads, by their names."""

    @property
    def version(self) -> str:
        """Version of camgeo."""

    @property
    def options(self) -> Options:
        """What the scene says of the formats."""

    @property
    def values(self) -> Values:
        """The scene's values, by which it is seen in which formats it can be written."""

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the checks find of all discs."""

    @property
    def discs(self) -> Sequence[Product]:
        """The discs of the mechanism, this one first; for pictures of all."""

    @property
    def ledger(self) -> Ledger:
        """What was computed of it, and how long it took."""

    @property
    def drawn(self) -> DrawnDisc: ...

    @property
    def milled(self) -> MilledDisc: ...

    @property
    def tabulated(self) -> TabulatedCam: ...

    @property
    def pictured(self) -> PicturedCam: ...


Disc = TypeVar("Disc", bound=Product)


def disc_of(discs: Sequence[Disc], stem: str) -> Disc:
    """The disc of which a file named `stem` without its ending is.

    A name that ends as that of a further disc does is that of such a disc, whatever comes before.
    """
    main, *others = discs
    marks = [(disc, disc.name.removeprefix(main.name)) for disc in others if stem != main.name]
    return next((disc for disc, mark in marks if stem.lower().endswith(mark)), main)


@dataclass(frozen=True, slots=True)
class Written:
    """A file's content and what its writer says of it.

    Attributes
    ----------
    data : the whole file.
    facts : what the certificate should name besides the deviation, e.g. {"arcs": 64}; numbers and
        short texts, in the order to be written.
    """

    data: bytes
    facts: dict[str, int | float | str] = field(default_factory=dict)


class Writer(Protocol):
    """One file format.

    Attributes
    ----------
    format : its declaration; the name is that of the entry point.

    A writer may have `companions` too, a tuple of writers: the format's further files, each with
    a suffix of its own.
    """

    @property
    def format(self) -> Format[Any]: ...

    def write(self, product: Product, tolerance: float) -> Written:
        """The file. `tolerance` [mm] bounds the distance of everything in it from the exact curve.

        Raises ToleranceError if that cannot be met.
        """

    def measure(self, product: Product, data: bytes) -> float | None:
        """Read `data` back and return the proved deviation [mm]; None for pictures."""
