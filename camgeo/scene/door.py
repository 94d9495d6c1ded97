"""The door of a scene: its values are judged, and the engine's objects are made of them."""

from __future__ import annotations

from typing import Any, Final

from camgeo.errors import SceneError
from camgeo.scene.build import Builder, Earlier
from camgeo.scene.data_files import DataFiles
from camgeo.scene.document import MOST_BYTES, Document
from camgeo.scene.rules import broken_rules
from camgeo.scene.sound import SoundValues
from camgeo.scene.source import Source
from camgeo.scene.words import judge

VERSION_KEY: Final = "camgeo"


def enter(document: Document, source: Source, earlier: Earlier | None = None) -> dict[str, Any]:
    """The attributes of the scene that says what `document` does.

    What is the same in an `earlier` scene, of which this is an edit, is taken from that one.

    Raises
    ------
    SceneError
        With all that is wrong.
    """
    verdict = judge(document)
    if (VERSION_KEY,) in verdict.bad and VERSION_KEY in document.exact:
        # A scene of another version has other keys; what this schema says of them misleads.
        found = [f for f in (*document.faults, *verdict.faults) if f.key == VERSION_KEY]
        raise SceneError(found, source.file)
    values = SoundValues(document, verdict.bad, verdict.meant)
    faults = [*document.faults, *verdict.faults, *broken_rules(values)]
    files = DataFiles(values, source.folder, source.contents)
    builder = Builder(values, files, earlier)
    # The plan makes some of these checks again, in its own words.
    moves = not any(fault.key.startswith("motion") for fault in faults)
    plan = builder.plan() if moves else None
    follower, linkage, speed_curve = builder.follower(), builder.linkage(), builder.speed_curve()
    returning = None if follower is None else builder.returning(follower)
    effects = builder.effects({fault.key for fault in faults})
    output = builder.output()
    if plan is not None and follower is not None and linkage is not None:
        builder.join(plan, follower, linkage)
    faults += [*files.faults, *builder.faults]
    if faults or plan is None or (follower is None and values.has("follower")):
        last = len(document.lines) + MOST_BYTES
        raise SceneError(sorted(faults, key=lambda fault: fault.line or last), source.file)
    return {
        "stated": values,
        "source": source.having(files.contents),
        "files": tuple(sorted(files.hashes.items())),
        "plan": plan,
        "follower": follower,
        "linkage": linkage,
        "returning": returning,
        "effects": effects,
        "output": output,
        **builder.rest(speed_curve),
    }
