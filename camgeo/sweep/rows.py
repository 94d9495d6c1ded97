"""Rows of a sweep, and the work that makes them, as it is sent to where it is done."""

from __future__ import annotations

import platform
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo._version import __version__
from camgeo.design import Design
from camgeo.errors import VersionError
from camgeo.scene.document import Source, document, document_of_tree
from camgeo.scene.scene import Scene
from camgeo.scene.tree import edited
from camgeo.sweep.asked import Asked
from camgeo.sweep.family import Family, Point
from camgeo.sweep.reading import TOGETHER, Reading, alike_designs, read, read_each, reason_of

if TYPE_CHECKING:
    from camgeo.lazy import Ledger

NOWHERE: Final = Path("/camgeo-sweep-has-no-folder")
"""Folder of the scenes of a sweep. A worker has the contents of the files that they name, and must
not read another file of its own machine under the same name."""

FOLLOWER: Final = "follower."
"""Keys that begin so are numbers and words of the follower."""

MOST_BEGUN: Final = 64
"""Scenes that are kept for others to share their plan, so that memory stays flat."""

MOST_TOGETHER: Final = 64
"""Designs that are computed at once: of 256 at once each costs 2 to 6 % less."""

LISTED: Final = "; "
"""Between the reasons of one row."""


@dataclass(frozen=True, slots=True)
class Row:
    """What one design of a family answers.

    Attributes
    ----------
    point : the values that make the design.
    values : what was asked, in the order asked; None where there is no answer.
    units : of the values, likewise; empty where there is none.
    reason : why something is missing; empty if nothing is, or if that is no failure, as of a
        finding that the design does not give rise to.
    """

    point: Point
    values: tuple[float | str | None, ...]
    units: tuple[str, ...]
    reason: str = ""

    @property
    def failed(self) -> bool:
        """Whether something that was asked has no answer."""
        return bool(self.reason)


@dataclass(frozen=True, slots=True)
class Versions:
    """What decides the bits of a row: the versions of camgeo, numpy and Python."""

    camgeo: str
    numpy: str
    python: str

    @classmethod
    def here(cls) -> Versions:
        """Those of this process."""
        return cls(__version__, np.__version__, platform.python_version())

    def require_here(self) -> None:
        """Raise VersionError, naming what differs, unless this process has the same."""
        here = self.here()
        for name in ("camgeo", "numpy", "python"):
            mine, theirs = getattr(here, name), getattr(self, name)
            if mine != theirs:
                label = name.capitalize() if name == "python" else name
                raise VersionError(
                    f"a worker has {label} {mine}, the sweep was started with {theirs}; rows of"
                    " both would not be comparable"
                )


@dataclass(frozen=True)
class Work:
    """All that a worker needs, wherever it runs; it can be pickled.

    Attributes
    ----------
    text : TOML of the scene that the family starts from.
    contents : of the files that designs name, by these names.
    keys : that vary.
    asked : of each design.
    versions : with which the rows are to be computed.
    """

    text: str
    contents: tuple[tuple[str, bytes], ...]
    keys: tuple[str, ...]
    asked: tuple[Asked, ...]
    versions: Versions

    @classmethod
    def of(cls, family: Family, asked: Iterable[Asked]) -> Work:
        """The work on a family, for processes with the versions of this one."""
        contents = tuple(sorted(family.contents().items()))
        text = family.scene.to_toml()
        return cls(text, contents, family.keys, tuple(asked), Versions.here())

    def __getstate__(self) -> dict[str, Any]:
        """The fields alone: whoever receives the work builds the scene."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def source(self) -> Source:
        """Where scenes get the contents of their files."""
        folder = NOWHERE.resolve() if self.contents else None
        return Source("", folder, self.text).having(dict(self.contents))

    @cached_property
    def base(self) -> Scene:
        """The scene that the family starts from; VersionError in a process of other versions."""
        self.versions.require_here()
        return Scene.of(document(self.text.encode()), self.source)

    @cached_property
    def _begun(self) -> dict[Hashable, Scene]:
        """A scene for each of the latest values at keys outside the follower: what does not depend
        on the follower, the plan above all, is that of all designs with these values.
        """
        return {}

    def scene_of(self, point: Point) -> Scene:
        """The scene of a design; SceneError with its faults."""
        edits = dict(zip(self.keys, point, strict=True))
        of_follower = {key: each for key, each in edits.items() if key.startswith(FOLLOWER)}
        others = tuple((type(each), each) for key, each in edits.items() if key not in of_follower)
        earlier = self._begun.get(others)
        start, edits = (self.base, edits) if earlier is None else (earlier, of_follower)
        tree = edited(start.stated.scene.exact, edits)
        document = document_of_tree(tree, earlier=start.stated.scene)
        found = Scene.of(document, self.source, start)
        if earlier is None:
            while len(self._begun) >= MOST_BEGUN:
                self._begun.pop(next(iter(self._begun)))
            self._begun[others] = found
        return found

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[Row]:
        """The rows of designs, each with the bits that it has alone; with the reason if its scene
        is wrong.

        What can be answered for many designs at once is.
        """
        base = self.base
        assert base is not None  # its errors are not those of one design
        found: dict[int, Row] = {}
        designs: dict[int, Design] = {}
        for number, point in enumerate(points):
            try:
                scene = self.scene_of(point)
                designs[number] = Design(scene) if ledger is None else Design(scene, ledger)
            except MemoryError:
                raise  # which is not the design's fault
            except Exception as error:
                found[number] = self.nothing(point, reason_of(error))
        answers = self._together(designs)
        for number in [*designs]:
            design = designs.pop(number)  # which has computed much, and is needed no longer
            readings = [
                answers.get((number, asked.word)) or read(design, asked) for asked in self.asked
            ]
            found[number] = self.answers(design, points[number], readings)
        return [found[number] for number in range(len(points))]

    def nothing(self, point: Point, reason: str) -> Row:
        """The row of a design that has no answers at all."""
        count = len(self.asked)
        return Row(point, (None,) * count, ("",) * count, reason)

    def _together(self, designs: Mapping[int, Design]) -> dict[tuple[int, str], Reading]:
        """What can be answered for many designs at once, by their numbers and what is asked."""
        words = [asked for asked in self.asked if asked.group in TOGETHER]
        groups: dict[Hashable, list[int]] = {}
        for number, design in sorted(designs.items(), key=_linkage) if words else ():
            groups.setdefault(alike_designs(design), []).append(number)
        return {
            (number, asked.word): reading
            for numbers in groups.values()
            for asked in words
            for number, reading in zip(
                numbers, read_each([designs[each] for each in numbers], asked), strict=True
            )
        }

    def answers(self, design: Design, point: Point, found: Sequence[Reading]) -> Row:
        """The row of a design, of which `found` is what is asked."""
        reasons: dict[str, list[str]] = {}
        for asked, reading in zip(self.asked, found, strict=True):
            if reading.reason:
                reasons.setdefault(reading.reason, []).append(asked.word)
        stated = [f"{', '.join(words)}: {reason}" for reason, words in reasons.items()]
        return Row(
            point,
            tuple(each.value for each in found),
            tuple(each.unit for each in found),
            LISTED.join(stated),
        )


def _linkage(item: tuple[int, Design]) -> int:
    """Designs with the same linkage one after another have the same motion: the plan keeps one."""
    return id(item[1].scene.linkage)


def rows_of(work: Work, points: Iterable[Point]) -> tuple[Row, ...]:
    """The rows of several designs, as a worker computes them."""
    known, rest = _known(work), iter(points)
    found: list[Row] = []
    while some := tuple(islice(rest, MOST_TOGETHER)):
        found += known.rows(some)
    return tuple(found)


@lru_cache(maxsize=1)
def _known(work: Work) -> Work:
    """The work as it came first, with its scene: each chunk brings another copy."""
    return work
