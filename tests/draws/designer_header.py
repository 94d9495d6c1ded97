"""Scenes as the designer judges them: its header says what `camgeo check --json` says.

    python -m tests.draws.designer_header [--browser] [--count N] [--seed HEX] [--rows FILE]

The cases are each effect switched on in each template, each scene of `fixtures` and of the folders
that are named, and N random edits of those of `fixtures`: values of fields, segments, effects and
kinds of followers. The answer to compare with is that of the command, its exit code and the
severities in its document. A fault with a key must be at a line that names it, or what is around
it. An effect that is switched on must be computed, or the change be refused with a sentence. With
`--browser` each text is entered in the page, in Chromium, and it is the page's header that counts.
"""

from __future__ import annotations

import io
import json
import random
import re
import sys
from argparse import Namespace
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from camgeo.app.cli.main import main as command
from camgeo.app.designing.children import Job
from camgeo.app.designing.faults import scene_verdict
from camgeo.app.designing.work import run
from tests.draws.run import Case, parser_of, run_cases
from tests.judges.browsing import driven
from tests.judges.chromium_designer import serving, shown, workshop

CODES: Final = {"ok": 0, "warning": 0, "broken": 1, "no-disc": 1, "invalid": 2}
"""Exit codes of `camgeo check` by the severity of the header; any other is no verdict."""

WORST: Final = ("invalid", "no-disc", "broken", "warning", "ok")

ACTIONS: Final = ("insert", "remove", "split", "up", "down", "to-dwell", "to-move")

FACTORS: Final = (-1.0, 0.0, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0)
"""By which a number of a field is multiplied."""

NAMES: Final = re.compile(r"[\w-]+")

Painted = Callable[[str], str]
"""The class of the page's header for a text."""

HEADER: Final = """() => camgeo.session.known && !camgeo.session.waits
  && document.querySelector("a.verdict").className.replace(/^verdict /, "")"""

LONG: Final = 36000.0
"""Seconds after which the browser is ended."""


@dataclass(frozen=True)
class Judged:
    """A scene, and what is wrong with its header; empty if nothing is."""

    name: str
    severity: str
    miss: str


def done(kind: str, text: str = "", file: Path = Path("cam.toml"), **arguments: Any) -> Any:
    """The result of a job of the designer, as a page is sent it."""
    found = run(Job(kind, text, str(file), str(file.parent), arguments))
    return json.loads(json.dumps(found, allow_nan=False))


def header(text: str, file: Path) -> dict[str, Any]:
    """What the page is told of a text as of a file: the verdict on its curves and findings."""
    return scene_verdict({kind: done(kind, text, file) for kind in ("curves", "findings")})


def checked(text: str, file: Path) -> tuple[int, set[str]]:
    """Exit code of `camgeo check --json` for the same text, and the severities in its document."""
    file.write_text(text, "utf-8")
    out = io.StringIO()
    with redirect_stdout(out), redirect_stderr(io.StringIO()):
        code = command(["check", str(file), "--json"])
    document = json.loads(out.getvalue()) if out.getvalue().strip() else {}
    return code, set(_severities(document))


def _severities(found: Any) -> Iterator[str]:
    if isinstance(found, dict):
        if isinstance(found.get("severity"), str):
            yield found["severity"]
        found = list(found.values())
    if isinstance(found, list):
        for each in found:
            yield from _severities(each)


@contextmanager
def painting(folder: Path) -> Generator[Painted]:
    """The page of the designer, in a browser."""
    with (
        driven(LONG) as browser,
        serving(folder) as server,
        shown(browser, server.host, server.way) as page,
    ):

        def painted(text: str) -> str:
            if page.text != text:
                page.write(text)
            found: str = page.visit.ask("the verdict", HEADER)
            return found

        yield painted


def case(name: str, text: str, file: Path, painted: Painted | None = None) -> Judged:
    """Judge a text by both doors, and as it is painted."""
    found = header(text, file)
    severity = found["severity"]
    code, severities = checked(text, file)
    said = next((each for each in WORST if each in severities), "invalid" if code == 2 else "ok")
    miss = ""
    if CODES.get(severity) != code or (severity != said and not found["faults"]):
        miss = f"the command ends with {code}, {said}"
    elif bool(found["faults"]) and severity != "invalid":
        miss = "faults, and not invalid"
    if painted and (colour := painted(text)) != severity:
        miss = f"painted as {colour}"
    return Judged(name, severity, miss or misplaced(found["faults"], text))


def misplaced(faults: list[dict[str, Any]], text: str) -> str:
    """Which fault with a key is at no line that names it, or what is around it; empty if none."""
    lines = text.splitlines()
    for fault in faults:
        names = set(NAMES.findall(fault["key"]))
        line = fault["line"]
        here = set(NAMES.findall(lines[line - 1])) if line else set()
        stated = names & set(NAMES.findall(text))
        if stated and not names & here and not fault["key"].endswith("]"):
            return f"{fault['key']} is said to be at line {line}"
    return ""


def switched(
    name: str, text: str, effect: str, file: Path, painted: Painted | None = None
) -> Judged:
    """Switch an effect on: it is computed, or the change is refused with a sentence."""
    changed = done("change", text, file, effect={"name": effect, "on": True})
    if "refused" in changed:
        return Judged(name, "refused", "" if changed["refused"] else "without a reason")
    found = case(name, changed["text"], file, painted)
    return Judged(name, found.severity, found.miss or ("faults" * (found.severity == "invalid")))


def edit(draw: random.Random, curves: Mapping[str, Any]) -> dict[str, Any]:
    """A random change, as a page can ask for it."""
    fields = [field for section in curves["form"] for field in section["fields"]]
    fields += [field for segment in curves["plan"] for field in segment["fields"]]
    kind = draw.random()
    if kind < 0.2:
        effects = [each["name"] for each in done("effects")["effects"]]
        name = draw.choice(effects)
        return {"effect": {"name": name, "on": name not in curves["effects"]}}
    if kind < 0.3 and curves["plan"]:
        return {
            "segment": {"action": draw.choice(ACTIONS), "at": draw.randrange(len(curves["plan"]))}
        }
    if kind < 0.35:
        kinds = [each["kinds"] for each in curves["form"] if each["key"] == "follower"]
        if kinds and kinds[0]:
            return {"table": {"key": "follower", "kind": draw.choice(kinds[0])["value"]}}
    field = draw.choice(fields)
    return {"edits": {field["key"]: value(draw, field)}}


def value(draw: random.Random, field: Mapping[str, Any]) -> Any:
    """Another value of a field: a number near or far, one of its choices, or none."""
    if draw.random() < 0.1:
        return None
    if field["type"] == "flag":
        return not field["value"]
    if field.get("choices"):
        return draw.choice(field["choices"])
    if field["type"] == "number":
        stated = field["value"] if field["value"] is not None else field.get("default")
        return round(draw.choice(FACTORS) * float(stated or 1.0), 6)
    return field["value"]


def cases(
    count: int, seed: int, scenes: Path, more: tuple[Path, ...] = (), painted: Painted | None = None
) -> Iterator[Judged]:
    """All of them; `scenes` holds those of `fixtures`, and the files that they name."""
    names = sorted(path.name for path in scenes.glob("*.toml"))
    file = scenes / "drawn.toml"
    for each in done("templates")["templates"]:
        for effect in done("effects")["effects"]:
            title = f"{each['name']} with {effect['name']}"
            yield switched(title, each["text"], effect["name"], file, painted)
    for path in [*(scenes / name for name in names), *more]:
        yield case(path.name, path.read_text("utf-8"), scenes / path.name, painted)
    draw = random.Random(seed)
    yield from edits(count, draw, [scenes / name for name in names], file, painted)


def edits(
    count: int, draw: random.Random, paths: list[Path], file: Path, painted: Painted | None = None
) -> Iterator[Judged]:
    """Random edits of these scenes, of which a few are made one after the other."""
    for number in range(count):
        path = draw.choice(paths)
        text, asked = path.read_text("utf-8"), []
        for _ in range(draw.randint(1, 3)):
            asked.append(edit(draw, done("curves", text, file)))
            text = done("change", text, file, **asked[-1]).get("text", text)
        yield case(f"{number} {path.name} {json.dumps(asked)}", text, file, painted)


def judged(asked: Namespace) -> Iterator[Case]:
    """All of them, each with its severity."""
    with ExitStack() as stack:
        scenes = Path(stack.enter_context(TemporaryDirectory()), "scenes")
        workshop(scenes)
        painted = stack.enter_context(painting(scenes)) if asked.browser else None
        for each in cases(asked.count, asked.seed, scenes, tuple(asked.scenes), painted):
            yield f"{each.name}: {each.severity}", [each.miss] if each.miss else []


if __name__ == "__main__":
    parser = parser_of(__doc__, 100)
    parser.add_argument("--browser", action="store_true")
    parser.add_argument("scenes", type=Path, nargs="*")
    sys.exit(run_cases(parser, judged))
