"""Reading of a scene file: everything that is wrong with it is told at once."""

from __future__ import annotations

import errno
from os import PathLike
from pathlib import Path
from typing import Final

from camgeo.errors import Fault, SceneError
from camgeo.scene.build import Builder
from camgeo.scene.document import MOST_BYTES, document
from camgeo.scene.fingerprint import hash_of
from camgeo.scene.model import Scene, SceneSource
from camgeo.scene.rules import broken_rules
from camgeo.scene.sound import SoundValues
from camgeo.scene.words import judge

VERSION_KEY: Final = "camgeo"


def load_scene(path: str | PathLike[str]) -> Scene:
    """Read the scene file at `path`.

    Raises
    ------
    SceneError
        If the file cannot be read or anything in it is wrong; it tells all faults.
    """
    file = str(path)
    try:
        if Path(path).is_dir():
            raise IsADirectoryError(errno.EISDIR, "it is a folder")
        with Path(path).open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except FileNotFoundError as error:
        raise SceneError([Fault("", "", "there is no such file")], file) from error
    except (OSError, ValueError) as error:
        # A ValueError is Python's answer to a path that no file can have.
        reason = getattr(error, "strerror", None) or str(error)
        fault = Fault("", "", f"the file cannot be read: {reason}")
        raise SceneError([fault], file) from error
    return _scene(data, file)


def parse_scene(text: str, file: str = "") -> Scene:
    """Read a scene from its text; `file` is the path it came from, for messages.

    Raises SceneError as `load_scene` does.
    """
    try:
        data = text.encode()
    except UnicodeEncodeError as error:
        fault = Fault("", "", "the scene is no text that UTF-8 can hold")
        raise SceneError([fault], file) from error
    return _scene(data, file)


def _scene(data: bytes, file: str) -> Scene:
    text = document(data, file)
    source = SceneSource(file, hash_of(data, text))
    verdict = judge(text)
    if (VERSION_KEY,) in verdict.bad and VERSION_KEY in text.exact:
        # A scene of another version has other keys; what this schema says of them misleads.
        raise SceneError([f for f in (*text.faults, *verdict.faults) if f.key == VERSION_KEY], file)
    values = SoundValues(text, verdict.bad, verdict.meant)
    faults = [*text.faults, *verdict.faults, *broken_rules(values)]
    builder = Builder(values)
    # The plan makes some of these checks again, in its own words.
    moves = not any(fault.key.startswith("motion") for fault in faults)
    plan = builder.plan() if moves else None
    follower, linkage, speed_curve = builder.follower(), builder.linkage(), builder.speed_curve()
    returning = None if follower is None else builder.returning(follower)
    effects = builder.effects({fault.key for fault in faults})
    output = builder.output()
    if plan is not None and follower is not None and linkage is not None:
        builder.join(plan, follower, linkage)
    faults += [*builder.files.faults, *builder.faults]
    if faults or plan is None or follower is None:
        last = len(text.lines) + MOST_BYTES
        raise SceneError(sorted(faults, key=lambda fault: fault.line or last), file)
    return builder.scene(plan, follower, linkage, returning, speed_curve, effects, output, source)
