"""The files of a scene, looked at again and again to see whether they have changed."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from camgeo.errors import SceneError
from camgeo.reading import SCENE
from camgeo.scene.load import read_file
from camgeo.scene.named import Stamp, named, stamp

Stamps = dict[Path, Stamp]


class SceneFiles:
    """The scene file and the files in its folder that its texts name.

    A scene that is broken for a moment, or a file that is missing, must be seen to be mended, so
    any text of the scene counts as a name, and while the scene cannot be read its last names do.
    """

    def __init__(self, scene: str) -> None:
        self.scene = Path(scene)
        self._read: Stamp = None
        self._named: tuple[Path, ...] = ()

    def stamps(self) -> Stamps:
        """The present state of all files."""
        own = stamp(self.scene)
        if own != self._read:
            self._read = own
            with suppress(SceneError, ValueError):  # read again when it changes again
                text = read_file(self.scene, SCENE.size).decode()
                found = named(text, self.scene.resolve().parent)
                self._named = self._named if found is None else found
        return {self.scene: own} | {path: stamp(path) for path in self._named}


def watch(
    files: Callable[[], Stamps], act: Callable[[], None], wait: Callable[[], None], runs: int = 0
) -> None:
    """Call `act` at once, and again after each change of `files`; `wait` passes between two looks.

    A change counts once two looks see the same: a file that is being written is left alone. What
    changes while `act` runs is seen afterwards. It ends after `runs` calls, never if that is 0.
    """
    done = 0
    while True:
        seen = files()
        act()
        done += 1
        if done == runs:
            return
        while (now := files()) == seen:
            wait()
        while now != (now := _after(wait, files)):
            pass


def _after(wait: Callable[[], None], files: Callable[[], Stamps]) -> Stamps:
    wait()
    return files()
