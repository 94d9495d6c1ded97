"""What each door says of the effects of a scene: the same findings, with the same verdicts.

    python -m tests.draws.doors [--count N] [--seed HEX] [--rows FILE]

The doors are Python, the check as JSON and in words, the report, the page of the designer, sweeps
and notebooks. They are opened for all scenes with effects in `fixtures`, and for N random ones.
"""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from collections.abc import Iterator, Mapping
from html import unescape
from pathlib import Path
from random import Random
from typing import Any, Final

from camgeo.app.answers.answer import text, to_json
from camgeo.app.answers.check import Check, check
from camgeo.app.answers.report import advised
from camgeo.app.designing.children import Job
from camgeo.app.designing.work import run
from camgeo.design.design import Design
from camgeo.dynamics.effects.results import FINDERS
from camgeo.errors import CamgeoError, EffectError, GeometryError, SceneError
from camgeo.scene.scene import parse_scene
from camgeo.studies.sweep.rows import hyphened, parse_questions, read
from camgeo_export.notebook.display import display
from tests.draws.run import Case, parser_of, run_cases
from tests.effects.test_random_scenes import scene_of

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

WORST: Final = ("invalid", "no-disc", "broken", "warning", "ok")

WORDS: Final = {"invalid": "INVALID", "no-disc": "NO DISC", "broken": "BROKEN"}
"""What is printed of a verdict, if not the verdict itself."""

Said = list[tuple[str, str, str]]
"""The findings of an effect: name, printed verdict and sentence."""

LINE: Final = re.compile(r"^(.{7}) (\S+) {2,}(.+)$")

ROW: Final = re.compile(r"<tr>(.*?)</tr>", re.DOTALL)
CELL: Final = re.compile(r"<t[dh][^>]*>(.*?)</t[dh]>", re.DOTALL)
TAG: Final = re.compile(r"<[^>]*>")


def scenes_with_effects() -> list[Path]:
    """All scenes of the fixtures that name effects."""
    paths = [path for name in ("effects", "found") for path in (FIXTURES / name).glob("*.toml")]
    return sorted(path for path in paths if "\n[effects." in path.read_text("utf-8"))


def random_scene(rng: Random) -> tuple[str, str]:
    """File and text of a valid scene with effects; none whose train acts back on a speed to be
    found, which may take minutes, and of which `fixtures` have some.
    """
    while True:
        file, scene = scene_of(rng)
        try:
            named = parse_scene(scene, file).effects
        except SceneError:
            continue
        if named and not ("vibration" in named and not {*FINDERS}.isdisjoint(named)):
            return file, scene


def printed(finding: Mapping[str, Any]) -> str:
    """The verdict on a finding of the JSON document, by what it is said to mean."""
    severity: str = finding["severity"]
    if severity == "ok" and finding["limit"] is None:
        return "note" if finding["value"] is None else "figure"
    return WORDS.get(severity, severity)


def of_json(document: Mapping[str, Any]) -> dict[str, Said]:
    """By effect."""
    return {
        effect: [(each["name"], printed(each), each["sentence"]) for each in findings]
        for effect, findings in document["effects"].items()
    }


def of_text(words: str, effects: Mapping[str, Any]) -> dict[str, Said]:
    """Of what the command prints, by effect."""
    found: dict[str, Said] = {effect: [] for effect in effects}
    about = ""
    for line in words.splitlines():
        if line.endswith(":") and not line.startswith(" "):
            about = line.removesuffix(":")
        elif about in found and (match := LINE.match(line)):
            mark, name, sentence = match.groups()
            found[about].append((name, mark.rstrip(), sentence))
    return found


def of_html(page: str) -> list[dict[str, str]]:
    """The rows of the tables of a page, by their headings."""
    heads: list[str] = []
    found = []
    for row in ROW.findall(page):
        cells = [unescape(TAG.sub("", cell)) for cell in CELL.findall(row)]
        if "<th" in row:
            heads = cells
        else:
            found.append(dict(zip(heads, cells, strict=True)))
    return found


def of_notebook(page: str) -> Said:
    """Of a table of findings; the sign before a verdict says the same."""
    return [
        (row["finding"], row["verdict"].partition(" ")[2], row["description"])
        for row in of_html(page)
    ]


def of_python(design: Design, effect: str) -> Said | str:
    """The findings of a result, or why there is none."""
    try:
        findings = design.effect(effect).findings
    except (EffectError, GeometryError) as error:
        return str(error)
    return [
        (each.name, printed({key: getattr(each, key) for key in ("severity", "limit", "value")}),
         each.sentence)
        for each in findings
    ]  # fmt: skip


def of_report(found: Check) -> dict[str, Said]:
    """Of the table that a report has, by effect."""
    told: dict[str, Said] = {}
    for each in advised(found):
        verdict = WORDS.get(each.finding.verdict, each.finding.verdict)
        told.setdefault(each.subject, []).append(
            (each.finding.name, verdict, each.finding.sentence)
        )
    return told


def of_page(file: str, scene: str) -> dict[str, Said]:
    """Of the list that the designer shows, by effect."""
    folder = str(Path(file).parent)
    told: dict[str, Said] = {}
    for each in run(Job("findings", scene, file, folder, {"machining": False}))["findings"]:
        told.setdefault(each["about"], []).append((each["name"], each["mark"], each["sentence"]))
    return told


def contradictions(file: str, scene: str, *, page: bool = True) -> Iterator[str]:
    """What one door says of an effect of a scene and another one does not."""
    parsed = parse_scene(scene, file)
    design = Design(parsed)
    if any(each.severity == "invalid" for each in design.findings):
        return
    by_python = {effect: of_python(design, effect) for effect in parsed.effects}
    try:
        found = check(Design(parsed), machining=False)
    except GeometryError as error:
        if str(error) not in by_python.values():
            yield f"only the check refuses: {error}"
        return
    document = to_json(found)
    right = of_json(document)
    doors: dict[str, Mapping[str, Said | str]] = {
        "python": by_python,
        "text": of_text(text(found), right),
        "report": of_report(found),
    }
    if page:
        doors["page"] = of_page(file, scene)
    doors["notebook"] = {
        effect: of_notebook(str(display(design.effect(effect))["text/html"]))
        for effect, said in by_python.items()
        if not isinstance(said, str)
    }
    for door, told in doors.items():
        for effect, said in right.items():
            other = told.get(effect, [] if door != "notebook" else said)
            if isinstance(other, str):  # there is no result, and the last finding says why
                if said[-1][1] != "BROKEN" or other not in said[-1][2]:
                    yield f"{door}: {effect}: {other!r}, not {said!r}"
            elif other != said:
                yield f"{door}: {effect}: {other!r}, not {said!r}"
    yield from _swept(design, document)


def _swept(design: Design, document: Mapping[str, Any]) -> Iterator[str]:
    """What a sweep answers otherwise than the check: its verdict, and values of findings."""
    parts = [each["findings"] for each in document["parts"].values()]
    groups = [document["findings"], *document["effects"].values(), *parts]
    severities = {each["severity"] for group in groups for each in group}
    worst = next((each for each in WORST if each in severities), "ok")
    (asked,) = parse_questions(design, ["verdict"])
    if read(design, asked).value != worst:
        yield f"sweep: verdict {read(design, asked).value!r}, not {worst!r}"
    known = {each["name"] for group in (document["findings"], *parts) for each in group}
    first: dict[str, Any] = {}
    for findings in document["effects"].values():
        for each in findings:
            first.setdefault(hyphened(each["name"]), each["value"])
    for name, value in first.items():
        if name in known:
            continue
        (asked,) = parse_questions(design, [name])
        answer = read(design, asked).value
        if answer != (value if value is None else value + 0.0):
            yield f"sweep: {name} {answer!r}, not {value!r}"


def opened(asked: Namespace) -> Iterator[Case]:
    """The scenes of the fixtures, and as many random ones as are asked for."""
    rng = Random(asked.seed)
    cases = [(path.stem, str(path), path.read_text("utf-8")) for path in scenes_with_effects()]
    cases += [(f"random {number}", *random_scene(rng)) for number in range(asked.count)]
    for name, file, scene in cases:
        try:
            yield name, [*contradictions(file, scene, page=not name.startswith("random "))]
        except CamgeoError as error:
            yield name, [f"{type(error).__name__}: {error}"]


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 100), opened))
