"""Writes docs/answers.md and the schemas of answers: `python docs/answers_page.py`.

The page describes the JSON documents of the commands; page and schemas are made from the keys that
the modules in `camgeo.app.answers` state, and their types. A test holds both to them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from camgeo.app import answers
from camgeo.app.answers.answer import document_schema
from camgeo.app.cli.main import COMMANDS

PAGE: Final = Path(__file__).with_name("answers.md")

HEAD: Final = """\
# Answers as JSON

<!-- Made from the answers in camgeo/app/answers by docs/answers_page.py; change them there. -->

With `--json` a command prints its answer as one JSON document; if it has no answer, it prints its
faults as one ([`camgeo/refusal`](#camgeorefusal)). The keys `schema` and `version` identify the
kind of document, and `camgeo` is the version of the program. Removing a key or changing its meaning
gives the document a new version; adding a key does not.
Lengths are in mm and angles in degrees, as the names of the keys say, unless another key of the
same object names a different unit. Sentences state lengths in the unit of the scene.

Each document has a JSON Schema (draft 2020-12), shipped with the code that makes the answer, as
`camgeo/app/answers/NAME.json`. In addition to the keywords of JSON Schema it uses `x-unit`, the
unit of a number, and `x-attribute`, the name of its value in Python.

In Python the same answers are frozen dataclasses, in mm and radians:

```python
import camgeo
from camgeo.app.answers.check import check
from camgeo.app.answers.answer import text, to_json

found = check(camgeo.load("fixtures/scenes/setzhub.toml"))
found.findings  # as data
print(text(found))  # as `camgeo check` prints it
to_json(found)  # as `camgeo check --json` prints it
```

A key in parentheses is omitted if it has no value. `[]` marks the items of a list, `*` stands for
names that depend on the scene.
"""

OF_ALL: Final = ("schema", "version", "camgeo")
"""Keys that all documents have."""

LAST: Final = "refusal"
"""The answer that belongs to no command."""


def page() -> str:
    """The page's text."""
    return HEAD + "".join(_section(document_schema(name)) for name in packages())


def packages() -> list[str]:
    """The modules with answers, in the order of the commands."""
    found = {path.stem for path in Path(answers.__path__[0]).glob("*.py")}
    names = [name for name in (command.replace("-", "_") for command in COMMANDS) if name in found]
    assert found == {*names, LAST, "answer", "__init__"}
    return [f"{answers.__name__}.{name}" for name in (*names, LAST)]


def schema_file(package: str) -> Path:
    """Where the schema of a module's answers is shipped."""
    return Path(answers.__path__[0]) / f"{package.rpartition('.')[2]}.json"


def schema_text(package: str) -> str:
    """What stands there."""
    return json.dumps(document_schema(package), ensure_ascii=False) + "\n"


def _section(schema: Mapping[str, Any]) -> str:
    properties = schema["properties"]
    name, version = (properties[key]["const"] for key in ("schema", "version"))
    rows = "".join(
        f"| `{key}` | {kind} | {description} |\n"
        for key, kind, description in _rows(schema, "")
        if key not in OF_ALL
    )
    return (
        f"\n## `{name}`\n\n{schema['description']} Version {version}.\n\n"
        f"| key | type | meaning |\n|---|---|---|\n{rows}"
    )


def _rows(node: Mapping[str, Any], path: str) -> Iterator[tuple[str, str, str]]:
    """The keys below a node: path, type, description."""
    if "items" in node:
        yield from _rows(node["items"], f"{path}[]")
    each = node.get("additionalProperties")
    if isinstance(each, Mapping):
        yield from _rows(each, f"{path}.*")
    required = node.get("required", ())
    for key, inner in node.get("properties", {}).items():
        shown = f"{path}.{key}" if path else key
        description = str(inner.get("description", "")).replace("|", "\\|")
        yield shown if key in required else f"{path}.({key})".lstrip("."), _kind(inner), description
        yield from _rows(inner, shown)


def _kind(node: Mapping[str, Any]) -> str:
    """What a value may be."""
    if "const" in node:
        return f"`{node['const']}`"
    if "enum" in node:
        return ", ".join(f"`{each}`" for each in node["enum"])
    stated = node["type"]
    return " or ".join([stated] if isinstance(stated, str) else stated)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    for name in packages():
        schema_file(name).write_text(schema_text(name), encoding="utf-8")
