"""A case: files in an empty folder, and what camgeo is called with there; kept as TOML or JSON."""

from __future__ import annotations

import base64
import copy
import json
import pathlib
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import tomlkit

CORPUS: Final = pathlib.Path(__file__).with_name("corpus")

SLOW: Final = CORPUS / "slow"
"""Cases that take about a second or more: in the long form of the tests."""

OPEN: Final = CORPUS / "open"
"""Cases that still fail: their reasons begin with what fails, then the revision and the cause."""

SCENE: Final = "scene.toml"
"""Name of the scene of a case."""

PYTHON: Final = "python"
"""First word of a step that asks camgeo from Python: all findings and effects of a scene."""

SCENE_STEPS: Final = (
    (PYTHON, SCENE),
    ("check", SCENE),
    ("build", SCENE, "-o", "out"),
    ("verify", "out"),
)
"""What is asked of a scene that is kept as TOML."""

Step = tuple[str, ...]


toml: Final = tomlkit.dumps
"""A tree as TOML, with all numbers that TOML has."""


@dataclass(frozen=True, slots=True)
class Case:
    """Files by their names, and the calls in their order: words of the command line.

    `source` says how it was drawn, or in the corpus why it is kept. `both` says whether a command
    that also answers in JSON is called in both forms.
    """

    files: dict[str, bytes]
    steps: tuple[Step, ...]
    source: str = ""
    both: bool = True

    @property
    def text(self) -> str:
        """All that camgeo is given, in lower case: what it may repeat in messages."""
        words = [word for step in self.steps for word in step]
        texts = [data.decode("utf-8", "replace") for data in self.files.values()]
        return "\n".join((*words, *texts)).lower()

    @property
    def values(self) -> dict[str, Any] | None:
        """The tree of the scene; None if it is no TOML."""
        try:
            return tomllib.loads(self.files[SCENE].decode())
        except (KeyError, ValueError, RecursionError):
            return None

    def with_file(self, name: str, data: bytes) -> Case:
        """The case with another content of a file."""
        return replace(self, files={**self.files, name: data})

    def with_values(self, values: dict[str, Any]) -> Case:
        """The case with another scene."""
        return self.with_file(SCENE, toml(values).encode())


Path = tuple[str | int, ...]
"""Of a value in a tree: keys of tables, numbers in lists."""


def paths(value: Any, path: Path = ()) -> Iterator[Path]:
    """Paths of all values in tables and lists."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield (*path, key)
            yield from paths(inner, (*path, key))


def value_at(values: Any, path: Path) -> Any:
    for step in path:
        values = values[step]
    return values


def changed(values: dict[str, Any], path: Path, value: Any) -> dict[str, Any]:
    """A copy with another value at a path; None takes it away."""
    found = copy.deepcopy(values)
    inside = value_at(found, path[:-1])
    if value is None:
        del inside[path[-1]]
    else:
        inside[path[-1]] = value
    return found


# In files -----------------------------------------------------------------------------------------


def store(case: Case, stem: pathlib.Path) -> pathlib.Path:
    """Write a case under `stem`: as TOML what is a scene alone, else as JSON; give its path."""
    text = _text(case.files.get(SCENE, b""))
    plain = set(case.files) == {SCENE} and case.steps == SCENE_STEPS and case.both
    if plain and isinstance(text, str):
        path = stem.with_suffix(".toml")
        path.write_text(f"# {case.source}\n\n{text}", "utf-8")
        return path
    path = stem.with_suffix(".json")
    document: dict[str, Any] = {
        "reason": case.source,
        "steps": [list(step) for step in case.steps],
        "files": {name: _text(data) for name, data in case.files.items()},
    }
    if not case.both:
        document["both"] = False
    path.write_text(json.dumps(document, indent=1, ensure_ascii=False) + "\n", "utf-8")
    return path


def restore(path: pathlib.Path) -> Case:
    """The case in a file of the corpus."""
    text = path.read_text("utf-8")
    if path.suffix == ".toml":
        reason = text.splitlines()[0].removeprefix("# ")
        return Case({SCENE: text.encode()}, SCENE_STEPS, reason)
    document = json.loads(text)
    files = {
        name: data.encode() if isinstance(data, str) else base64.b64decode(data["base64"])
        for name, data in document["files"].items()
    }
    both = document.get("both", True)
    return Case(files, tuple(map(tuple, document["steps"])), document["reason"], both)


def _text(data: bytes) -> str | dict[str, str]:
    try:
        return data.decode()
    except UnicodeDecodeError:
        return {"base64": base64.b64encode(data).decode()}
