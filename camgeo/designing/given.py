"""What a change starts from, and the scenes that are tried in making it."""

from __future__ import annotations

import pathlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from camgeo.design import Design
from camgeo.errors import CamgeoError, Fault, GeometryError, SceneError
from camgeo.scene.document import Source, document_of_tree
from camgeo.scene.keys import Path, path_of
from camgeo.scene.scene import Scene
from camgeo.scene.tree import Tree, without

ROUNDS: Final = 6
"""How often keys are taken out: without some, others turn out not to belong."""


@dataclass(frozen=True)
class Given:
    """A text to be changed.

    Attributes
    ----------
    text : TOML.
    tree : its values.
    file, folder : where it comes from.
    known : its design, if there is one already.
    """

    text: str
    tree: Tree
    file: str
    folder: str | pathlib.Path | None
    known: Design | None

    @cached_property
    def source(self) -> Source:
        """Where the files lie that the scene names."""
        return Source.of(self.file, self.folder, self.text)

    @cached_property
    def design(self) -> Design:
        """Its design; SceneError if the scene is not valid."""
        return self.known or Design(self.scene(self.tree))

    def scene(self, tree: Tree) -> Scene:
        """The scene with other values; SceneError if they are not valid."""
        earlier = None if self.known is None else self.known.scene
        return Scene.of(document_of_tree(tree), self.source, earlier)

    def faults(self, tree: Tree) -> tuple[Fault, ...]:
        """What is wrong with other values."""
        try:
            self.scene(tree)
        except SceneError as error:
            return error.faults
        return ()

    @cached_property
    def wrong(self) -> frozenset[str]:
        """The keys at fault in the text as it is."""
        return frozenset(fault.key for fault in self.faults(self.tree))

    def new_faults(self, tree: Tree) -> tuple[Fault, ...]:
        """What is wrong with other values, at keys that are not `wrong` as it is."""
        return tuple(fault for fault in self.faults(tree) if fault.key not in self.wrong)

    def unmet(self, tree: Tree, name: str) -> Fault | None:
        """What the effect `name` lacks in a scene with other values, where only computing it tells.

        None as well if the text as it is has no design: then nothing can be computed.
        """
        if self.known is None:
            return None
        try:
            Design(self.scene(tree)).effect(name)
        except GeometryError as error:
            return Fault(error.key, error.value, error.message) if error.key else None
        except CamgeoError:  # faults of the scene, or no answer for this design, as findings tell
            return None
        return None

    def without_misfits(self, tree: Tree, may: Callable[[Path], bool]) -> Tree:
        """The tree without those of the `new_faults` that may be taken out.

        Some only turn out to be at fault when others are gone.
        """
        for _ in range(ROUNDS):
            paths = {path_of(fault.key) or () for fault in self.new_faults(tree)}
            misfits = [path for path in paths if path and may(path)]
            if not misfits:
                break
            for path in sorted(misfits, key=len, reverse=True):
                tree = without(tree, path)
        return tree


def refusal(message: str, key: str = "") -> SceneError:
    """A change that cannot be made, and why."""
    return SceneError([Fault(key, "", message)])
