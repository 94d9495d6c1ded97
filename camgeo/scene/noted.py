"""What has been read of a scene, and whether an edit changes it."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import Any, Final

from camgeo.scene.keys import Path

ABSENT: Final = object()


class Reads:
    """Places in a scene at which something looked.

    What depends on these values alone is the same for every scene that has the same there.
    """

    def __init__(self) -> None:
        self._places: set[Path] = set()
        self._around: set[Path] = set()

    def note(self, path: Path) -> None:
        """The value at `path`, with all that is in it, or that there is none."""
        if path not in self._places:
            self._places.add(path)
            self.note_presence(path)

    def note_presence(self, path: Path) -> None:
        """Whether there is a value at `path`, whatever it is."""
        self._around.update(path[:end] for end in range(len(path) + 1))

    def touched(self, change: Path) -> bool:
        """Whether a change at that place concerns one of these: around it, at it or in it."""
        if change in self._around:
            return True
        return any(change[:end] in self._places for end in range(len(change) + 1))


def unchanged(
    reads: Mapping[Hashable, Reads], then: Mapping[str, Any], now: Mapping[str, Any]
) -> dict[Hashable, Reads]:
    """Those of `reads` whose places have the same values in the trees `then` and `now`."""
    changed = list(changes(then, now))
    return {name: each for name, each in reads.items() if not any(map(each.touched, changed))}


def changes(then: Any, now: Any, path: Path = ()) -> Iterator[Path]:
    """The places at which two trees differ; what one of them shares with the other does not."""
    if then is now:
        return
    if isinstance(then, dict) and isinstance(now, dict):
        for key in {**then, **now}:
            yield from changes(then.get(key, ABSENT), now.get(key, ABSENT), (*path, key))
    elif isinstance(then, list) and isinstance(now, list) and len(then) == len(now):
        for place, (before, after) in enumerate(zip(then, now, strict=True)):
            yield from changes(before, after, (*path, place))
    else:
        yield path
