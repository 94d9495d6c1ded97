"""Changes of a scene's text: what is asked becomes values, which are written into the text.

Comments and order stay. A text is changed whether its scene is valid or not, as long as it is TOML.
"""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from camgeo.design import Design
from camgeo.designing.labels import label_of
from camgeo.errors import Fault, SceneError
from camgeo.scene.document import document
from camgeo.scene.toml import written_into
from camgeo.scene.tree import edited


@dataclass(frozen=True, slots=True)
class Changed:
    """A text after a change.

    Attributes
    ----------
    text : the new TOML.
    label : names the change, for undo.
    """

    text: str
    label: str


def changed(
    text: str,
    file: str,
    folder: str | pathlib.Path | None,
    arguments: Mapping[str, Any],
    design: Design | None = None,
) -> Changed:
    """The `text` with one change, which `arguments` ask for.

    Parameters
    ----------
    file, folder : where the text comes from, as of `camgeo.scene.scene.Scene.from_text`.
    arguments : one of the kinds of changes, by its name, with what it takes:
        `edits`, values by key, None to remove the key.
    design : that of the text, if it is known.

    Raises
    ------
    SceneError
        If the text is not TOML, or has no place for what is asked; nothing is changed then.
    """
    del folder, design  # only changes of what was computed need them
    try:
        found = document(text.encode())
    except SceneError as error:
        raise SceneError(error.faults, file) from error
    edits = arguments.get("edits")
    if not isinstance(edits, Mapping):
        raise SceneError([Fault("", "", "the change names nothing that can be changed")], file)
    after = edited(found.exact, edits)
    return Changed(written_into(text, after), label_of(edits, {}))
