"""What a scene's hash is taken of: all of the file but the tables of effects.

Effects change nothing of the files that are made. So that these stay the same to the last byte,
with and without them, neither does the hash that stands in them.
"""

from __future__ import annotations

import hashlib

from camgeo.errors import SceneError
from camgeo.scene.document import Document, document

TABLE = "effects"


def scene_hash(data: bytes) -> str:
    """SHA-256 of the bytes of a scene file, hexadecimal, as it stands in the files made from it.

    Of what is no TOML it is that of all its bytes.
    """
    try:
        return hash_of(data, document(data, ""))
    except SceneError:
        return hashlib.sha256(data).hexdigest()


def hash_of(data: bytes, scene: Document) -> str:
    """The same of a file that is taken apart already, into `scene`."""
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
