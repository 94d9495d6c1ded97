"""Answer of `camgeo machines`: the machine profiles, or one of them with all its keys."""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Final, Literal

from camgeo.app.answers.answer import Answer, Key, Keys, aligned
from camgeo.app.cli.command import Argument, show
from camgeo.milling.machine import EVIDENCE, Evidence, Machine, load, names, schema


@dataclass(frozen=True, slots=True)
class Listed:
    """A machine profile with the name by which it is loaded.

    Attributes
    ----------
    profile : the name by which scenes refer to it.
    machine : contents of the profile.
    """

    profile: str
    machine: Machine

    @property
    def evidence(self) -> Mapping[str, int]:
        """Number of its statements of each kind, the best evidence first."""
        counts = Counter(statement.kind for statement in self.machine.evidence)
        return {kind: counts[kind] for kind in EVIDENCE if counts[kind]}


@dataclass(frozen=True, slots=True)
class ProfileKey:
    """A key of a profile.

    Attributes
    ----------
    key : with the names of its tables.
    value : as in a profile file.
    unit : of a number; empty if it has none.
    description : what it means.
    """

    key: str
    value: str
    unit: str
    description: str


@dataclass(frozen=True, slots=True)
class Machines(Answer):
    """Machine profiles.

    Attributes
    ----------
    listed : all profiles of camgeo; None if one was selected.
    selected : that profile; None for the list.
    """

    listed: tuple[Listed, ...] | None = None
    selected: Listed | None = None

    @property
    def keys(self) -> tuple[ProfileKey, ...] | None:
        """Keys of the selected profile, in the order of the schema; None for the list."""
        return None if self.selected is None else tuple(profile_keys(self.selected.machine))

    @property
    def evidence(self) -> tuple[Evidence, ...] | None:
        """Evidence of the selected profile; None for the list."""
        return None if self.selected is None else self.selected.machine.evidence


def machines() -> Machines:
    """The profiles of camgeo."""
    return Machines(tuple(Listed(name, load(name)) for name in names()))


def machine(name: str) -> Machines:
    """One profile, by its name or its file; SceneError with all its faults."""
    return Machines(selected=Listed(name, load(name, "PROFILE")))


def profile_keys(
    owner: Any, node: Mapping[str, Any] | None = None, path: str = ""
) -> Iterator[ProfileKey]:
    """The keys of a profile or of one of its tables that have a value, except its evidence."""
    nodes = (schema() if node is None else node)["properties"]
    for field in fields(owner):
        value, key = getattr(owner, field.name), f"{path}{field.name}"
        if value is None or key == "evidence":
            continue
        schema_node = nodes[field.name]
        if is_dataclass(value):
            yield from profile_keys(value, schema_node, f"{key}.")
        elif isinstance(value, Mapping):
            for name, item in value.items():
                quoted = name if name.replace("_", "").isalnum() else json.dumps(name)
                yield ProfileKey(f"{key}.{quoted}", _toml(item), "", schema_node["description"])
        else:
            yield ProfileKey(
                key, _toml(value), schema_node.get("x-unit", ""), schema_node["description"]
            )


def _toml(value: object) -> str:
    if isinstance(value, bool | str):
        return json.dumps(value)
    if isinstance(value, tuple):
        return f"[{', '.join(_toml(entry) for entry in value)}]"
    # Fifteen digits show every decimal number as it was stated.
    return f"{value:.15g}"


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


PROFILE: Final[Keys] = {
    "profile": "Name by which scenes refer to it, or its file.",
    "name": Key("Name in messages and programs.", of="machine.name"),
    "controller": Key("Controllers that it is meant for.", of="machine.controller"),
    "dialect": Key(
        "How blocks are spelled.", of="machine.dialect", type=Literal["iso", "klartext"]
    ),
    "extension": Key("Ending of its programs.", of="machine.extension"),
    "evidence": "Number of its statements of each kind.",
}

DOCUMENT: Final = Key(
    "The machine profiles of camgeo, or one profile, which may be a file of the user's own, with"
    " all its keys.",
    {
        "machines": Key(
            "All profiles, by name, if none was named.", PROFILE, of="listed", optional=True
        ),
        "profile": Key("The profile that was named.", PROFILE, of="selected", optional=True),
        "keys": Key(
            "Keys of the profile that have a value, in the order of docs/machines.md.",
            {
                "key": "Name of the key, with the names of its tables.",
                "value": "The value, as in a profile file.",
                "unit": "Unit of a number; empty if it has none.",
                "description": "Meaning of the key.",
            },
            optional=True,
        ),
        "evidence": Key(
            "The evidence for the profile that was named.",
            {
                "kind": Key(
                    'Kind of evidence; "none" if the statement is not confirmed.',
                    type=Literal["manual", "source code", "interpreter", "machine", "post", "none"],
                ),
                "about": "Keys or tables that it is about.",
                "text": "What the source says, or what is not confirmed.",
                "source": 'Place of that text; empty for kind "none".',
            },
            optional=True,
        ),
    },
    type=Machines,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo machines` in words.


WORDS = {
    "manual": "manual", "source code": "source code", "interpreter": "interpreter",
    "machine": "machine", "post": "post", "none": "not confirmed",
}  # fmt: skip
"""Words for the kinds of evidence."""


def text(answer: Machines) -> str:
    """One line per profile, or the keys of one with the evidence for them."""
    if answer.listed is not None:
        return "\n".join(_list(answer.listed))
    assert answer.selected is not None
    profile, machine = answer.selected, answer.selected.machine
    lines = [f"{profile.profile}: {machine.controller}", ""]
    lines += _keys(answer.keys or ())
    if machine.evidence:
        lines += ["", "evidence"]
    for statement in machine.evidence:
        lines.append(f"  {WORDS[statement.kind]}: {', '.join(statement.about)}")
        lines.append(f"    {statement.text}")
        lines += [f"    {statement.source}"] if statement.source else []
    return "\n".join(lines)


def _list(listed: Sequence[Listed]) -> list[str]:
    rows = []
    for profile in listed:
        counts = (f"{count} {WORDS[kind]}" for kind, count in profile.evidence.items())
        machine = profile.machine
        rows.append((profile.profile, machine.extension, machine.controller, ", ".join(counts)))
    return aligned(rows)


def _keys(keys: Sequence[ProfileKey]) -> list[str]:
    width = max(len(entry.key) for entry in keys)
    return [
        f"{entry.key:{width}} = {entry.value}{f' {entry.unit}' if entry.unit else ''}"
        for entry in keys
    ]


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = "camgeo machines haas"


ARGUMENTS: Final = (
    Argument(
        "profile",
        metavar="PROFILE",
        nargs="?",
        help="name of a profile, or a profile file (TOML); default: list them all",
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the list, or the profile that is named."""
    answer = machines() if arguments.profile is None else machine(arguments.profile)
    return show(answer, arguments)
