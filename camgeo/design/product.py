"""A finished disc, which is what writers see of a design."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import TYPE_CHECKING, Final

from camgeo._version import __version__
from camgeo.check.finding import RETURN, Finding
from camgeo.check.judge import Judgement
from camgeo.lazy import Ledger, built
from camgeo.part.spec import DISCS
from camgeo.record import Pickled
from camgeo.scene.formats.format import Options, Values
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from camgeo.cam.cam import Cam
    from camgeo.design.drawn import DrawnDisc
    from camgeo.design.milled import MilledDisc
    from camgeo.design.pictured import PicturedCam
    from camgeo.design.value_table import TabulatedCam
    from camgeo.dynamics.effects.effect import Column
    from camgeo.scene.scene import Scene


SECOND: Final = "second-side"
"""Suffix of the names of programs of the second side."""

ONE_PROGRAM: Final = re.compile(rf"(-{SECOND})?(-\d+-t\d+)?$", re.ASCII | re.IGNORECASE)
"""Suffixes of the name of one of several programs: its side, its number and its tool."""

PAIR: Final = "pair"
"""Suffix of the name of a conjugate pair in one piece."""

SHEET_SUFFIX: Final = "-drawing"
"""Suffix of the name of a drawing sheet."""


@dataclass(frozen=True)
class Product(Pickled):
    """One disc as its files show it: what all files share, and a view for each kind of file.

    Only the views that a writer reads are computed.

    Attributes
    ----------
    scene : the specification of the design.
    cam : the cam that the disc belongs to.
    judgement : the findings, and whether such a disc exists.
    others : the discs that turn with it: for a conjugate pair's main disc, the return disc.
    columns : gives the effects over the cam angle; effects without an answer are left out.
    ledger : records what was computed, and how long it took.
    program : number from 0 of one of the milling programs of a machine that cannot change tools,
        for whose file this is; None for all of them.
    second_side : whether this is the second side of the disc, for its programs.
    pair : for the main disc of a conjugate pair in one piece, that piece; else None.
    is_pair : whether this is such a piece, with the cam of the main disc.
    """

    scene: Scene
    cam: Cam
    judgement: Judgement
    others: tuple[Product, ...]
    columns: Callable[[], tuple[Column, ...]]
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)
    program: int | None = None
    second_side: bool = False
    pair: Product | None = None
    is_pair: bool = False

    @property
    def name(self) -> str:
        """Name of the disc or pair, the stem of its files.

        Programs of a second side have a suffix for that, and one of several programs has its number
        from 1 and its tool.
        """
        if self.is_pair:
            return f"{self.scene.name}-{PAIR}"
        name = f"{self.scene.name}-{RETURN}" if self.position else self.scene.name
        name = f"{name}-{SECOND}" if self.second_side else name
        if self.program is None:
            return name
        return f"{name}-{self.program + 1}-t{self.milled.cuts[0].tool.number}"

    @property
    def position(self) -> int:
        """0 for the main disc, 1 for the return disc."""
        return 0 if self.judgement.cams[0] is self.cam else 1

    @property
    def unit(self) -> LengthUnit:
        """Unit of length of the scene; drawings, programs and tables are written in it."""
        return self.scene.unit

    @property
    def scene_hash(self) -> str:
        """SHA-256 of what decides the files in the scene, see `camgeo.scene.scene.Scene.made`."""
        return self.scene.made

    @property
    def scene_files(self) -> dict[str, str]:
        """SHA-256 of the files that the scene reads, hexadecimal, by their names."""
        return dict(self.scene.files)

    @property
    def version(self) -> str:
        """Version of camgeo."""
        return __version__

    @property
    def options(self) -> Options:
        """The scene's options of the formats."""
        return self.scene.output.options

    @property
    def values(self) -> Values:
        """The scene's values, which decide the formats in which it can be written."""
        return self.scene.stated

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings of the checks on all discs."""
        return self.judgement.findings

    @property
    def discs(self) -> tuple[Product, ...]:
        """The disc, followed by those that turn with it, for pictures of all of them."""
        return (self, *self.others)

    @built
    def drawn(self) -> DrawnDisc:
        """The disc as drawings and solids show it."""
        from camgeo.design.drawn import DrawnDisc

        scene, spec, returning = self.scene, self.scene.part, None
        if self.is_pair:
            (other,) = self.others
            returning = other.cam
        elif spec is not None:
            spec = spec.alone(DISCS[self.position])
        return DrawnDisc(
            self.cam, spec, scene.output.fit, self.judgement, self.ledger, scene.printing, returning
        )

    @built
    def milled(self) -> MilledDisc:
        """The disc, or this side of it, as milling programs cut it."""
        from camgeo.design.milled import MilledDisc

        whole = MilledDisc(self.drawn, self.scene, self.ledger)
        if self.second_side:
            assert whole.second is not None  # which this is
            whole = whole.second
        return whole if self.program is None else whole.programs[self.program]

    @property
    def programs(self) -> tuple[Product, ...]:
        """The disc once for each milling program: one for each side, or more if the machine cannot
        change tools and several are needed.
        """
        return tuple(chain.from_iterable(map(side_programs, product_sides(self))))

    @built
    def tabulated(self) -> TabulatedCam:
        """The cam as value tables list it."""
        from camgeo.design.value_table import TabulatedCam

        return TabulatedCam(self.cam.drive, self.scene, self.cam, self.columns, self.ledger)

    @built
    def pictured(self) -> PicturedCam:
        """The cam as pictures show it."""
        from camgeo.design.pictured import PicturedCam

        returning = self.others[0].cam.follower if self.others else None
        return PicturedCam(self.cam, returning)


def product_sides(product: Product) -> tuple[Product, ...]:
    """The disc once for each side from which it is milled, the first side first.

    A product that is one program, or a second side, is returned alone.
    """
    second = product.milled.second
    if second is None or product.program is not None:
        return (product,)
    other = replace(product, second_side=True)
    # The views that both sides share are not computed again.
    other.__dict__.update(drawn=product.drawn, milled=second)
    return (product, other)


def side_programs(side: Product) -> tuple[Product, ...]:
    """The side of a disc once for each of its programs."""
    milled = side.milled.programs
    if len(milled) == 1:
        return (side,)
    products = tuple(replace(side, program=number) for number in range(len(milled)))
    for product, program in zip(products, milled, strict=True):
        product.__dict__.update(drawn=side.drawn, milled=program)
    return products


def solid_products(disc: Product) -> tuple[Product, ...]:
    """The products of which solids are made for a disc: the disc itself, or for a pair in one piece
    that piece, for its main disc only.
    """
    if disc.is_pair or disc.scene.part is None or disc.scene.part.pair is None:
        return (disc,)
    return () if disc.pair is None else (disc.pair,)


def with_pair(discs: Sequence[Product]) -> tuple[Product, ...]:
    """The discs, followed by the pair if they are one piece."""
    pair = discs[0].pair
    return (*discs, pair) if pair is not None else tuple(discs)


def display_title(disc: Product) -> str:
    """The name of the disc for people, in any characters: the title of the drawing, or its name."""
    title = disc.scene.drawing.title
    if not title:
        return disc.name
    if disc.is_pair:
        return f"{title} ({PAIR})"
    return f"{title} ({RETURN})" if disc.position else title


def find_disc(discs: Sequence[Product], stem: str) -> Product:
    """The disc to which a file belongs whose name without extension is `stem`.

    A name with the suffix of a further disc belongs to that disc, whatever precedes the suffix.
    """
    main, *others = with_pair(discs)
    stem = stem.removesuffix(SHEET_SUFFIX)
    # The design itself may have a name that looks like that of a program.
    stem = stem if stem == main.name else ONE_PROGRAM.sub("", stem)
    marks = [(disc, disc.name.removeprefix(main.name)) for disc in others if stem != main.name]
    return next((disc for disc, mark in marks if stem.lower().endswith(mark)), main)
