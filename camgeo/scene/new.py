"""Commented scenes to start from, for `camgeo new KIND`."""

from __future__ import annotations

import pathlib
from typing import Final

from camgeo.errors import UnknownNameError
from camgeo.mechanism.declared.registry import FOLLOWERS, LINKAGES

TEMPLATES: Final = pathlib.Path(__file__).with_name("templates")

MECHANISMS: Final = (
    *FOLLOWERS,
    "knife-edge",
    "groove",
    "conjugate-carriage",
    "conjugate-lever",
    "constant-breadth",
    *(name for kind in LINKAGES.values() for name in kind.templates),
)
"""Kinds with a mechanism of their own."""

KINDS: Final = (*MECHANISMS, "milled")
"""Kinds for which `template` has a scene; the first is the default of the command line."""


def template(kind: str) -> str:
    """Return the text of a commented scene of that kind; UnknownNameError if there is
    none.
    """
    if kind not in KINDS:
        raise UnknownNameError("template", kind, KINDS)
    return (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")
