"""The tables of followers and linkages in the schema, composed of what their kinds declare."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from camgeo.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.mechanism.kind import FollowerKind, LinkageKind


def with_kinds(frame: Mapping[str, Any]) -> dict[str, Any]:
    """The schema `frame` with the tables of all kinds of followers and linkages."""
    top = dict(frame["properties"])
    top["follower"] = _choice(top["follower"], FOLLOWERS.values())
    top["linkage"] = _choice(top["linkage"], LINKAGES.values())
    own = {name: _table(kind.schema) for name, kind in LINKAGES.items()}
    for name, kind in FOLLOWERS.items():
        own[name] = {**_table(kind.schema), "x-siblings": _siblings(kind)}
    return {**frame, "properties": top, "$defs": {**frame["$defs"], **own}}


def _choice(
    node: Mapping[str, Any], kinds: Iterable[FollowerKind] | Iterable[LinkageKind]
) -> dict[str, Any]:
    """A table whose other keys depend on its kind."""
    told = [(kind.name, kind.told) for kind in kinds]
    kind = {
        "description": " ".join(f'"{name}": {text}' for name, text in told),
        "enum": [name for name, _ in told],
    }
    cases = [
        {
            "if": {"properties": {"kind": {"const": name}}, "required": ["kind"]},
            "then": {"$ref": f"#/$defs/{name}"},
        }
        for name, _ in told
    ]
    return {**node, "properties": {"kind": kind}, "allOf": cases}


def _table(schema: Mapping[str, Any]) -> dict[str, Any]:
    return {**schema, "properties": {"kind": True, **schema["properties"]}}


def _siblings(kind: FollowerKind) -> list[str]:
    """The other kinds of followers, those first that touch the cam alike, then those held alike."""
    others = (other for other in FOLLOWERS.values() if other is not kind)
    return [
        other.name
        for other in sorted(
            others, key=lambda o: (o.touching != kind.touching, o.unit != kind.unit)
        )
    ]
