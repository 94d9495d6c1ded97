"""The hash of a scene's text, which stood in files before that of its values did.

It is taken of all of the text but the tables of effects, for these change nothing of the files that
are made. Files with it are verified all the same.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path

from camgeo.errors import SceneError
from camgeo.scene.document import Document, document
from camgeo.scene.identity import made_of

TABLE = "effects"


def hashes_of(path: Path, known: Mapping[str, str]) -> Iterator[str]:
    """What files may name the scene file at `path` by: the hash of its text, and of its values.

    Nothing of what is no TOML; OSError if it, or a file that it names, cannot be read. Those whose
    SHA-256 is `known` are taken for what they were then.
    """

    def digest(name: str) -> str:
        return known.get(name) or hashlib.sha256((path.parent / name).read_bytes()).hexdigest()

    data = path.read_bytes()
    try:
        scene = document(data)
    except SceneError:
        return
    yield hash_of(data, scene)
    if not scene.faults:
        yield made_of(scene.exact, digest)


def hash_of(data: bytes, scene: Document) -> str:
    """SHA-256 of the bytes of a scene file without its effects, hexadecimal.

    `scene` is the file taken apart.
    """
    return hashlib.sha256(without_effects(data, scene)).hexdigest()


def without_effects(data: bytes, scene: Document) -> bytes:
    """The bytes of a scene without the lines of what is under ``[effects]``.

    With these go the comments directly above and the empty lines below, or at the end of the file
    the empty lines above. A scene without effects is left as it is, and so is one in which it
    cannot be told which lines they are.
    """
    if TABLE not in scene.exact or not any(path[0] == TABLE for path in scene.lines):
        return data
    lines = data.splitlines(keepends=True)
    starts = sorted({line - 1 for line in scene.lines.values()})
    own = {line - 1 for path, line in scene.lines.items() if path[0] == TABLE}
    kept = [True] * len(lines)
    for number, start in enumerate(starts):
        if start not in own:
            continue
        end = starts[number + 1] if number + 1 < len(starts) else len(lines)
        last = max((k for k in range(start, end) if not _idle(lines[k])), default=start)
        after = last + 1
        while after < end and not lines[after].strip():
            after += 1
        before = start
        while before and lines[before - 1].lstrip().startswith(b"#"):
            before -= 1
        for k in range(before, after):
            kept[k] = False
    if own and lines and not kept[-1]:
        k = len(lines) - 1
        while k >= 0 and (not kept[k] or not lines[k].strip()):
            kept[k] = False
            k -= 1
    return b"".join(line for line, keep in zip(lines, kept, strict=True) if keep)


def _idle(line: bytes) -> bool:
    """Whether a line is empty or a comment."""
    text = line.strip()
    return not text or text.startswith(b"#")
