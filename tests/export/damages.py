"""Small damages to small files of each format, and all that verify and lint measure of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading
from camgeo.milling.machine import load
from camgeo.scene.scene import parse_scene
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import FACET, PREFIX
from camgeo_export.stl import WRITER as STL
from camgeo_export.svg import WRITER as SVG
from camgeo_export.threemf.writer import MODEL_PATH
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.gcode import VERIFIER
from tests import kept
from tests.export.verified import TOLERANCE, VERIFIERS
from tests.packages import repacked
from tests.toolpath import programs

ROOT: Final = Path(__file__).resolve().parents[2]

Damage = Callable[[str], str]


WRITERS: Final = {"dxf": DXF, "svg": SVG, "gcode": GCODE, "stl": STL, "3mf": THREEMF, "step": STEP}

SOLID: Final = programs.scene(
    programs.mill(1, 8),
    programs.FIXTURE,
    part="bore = 10\nkeyway = { width = 3, depth = 1.4 }\nhub = { diameter = 18, height = 4 }\n"
    "bolt_circle = { count = 2, circle = 30, hole = 4, angle = 30 }\n"
    'chamfers = { outline = { width = 0.5 }, bore = { width = 0.4, edges = "upper" } }',
)
"""A part with all that solids have: levels, holes, a keyway, chamfers above and below."""

GROOVE: Final = programs.scene(
    programs.mill(1, 12), programs.FIXTURE, contact="groove", part=programs.GROOVE
)


def drawn(entity: str) -> str:
    """The groove, drawn with one kind of entity."""
    return f'{GROOVE}\n[output.dxf]\nentity = "{entity}"\n'


PROGRAMS: Final = (
    "stated, all kinds",
    "stated, conventional",
    "stated, a spiral from a plate",
    "planned, a groove in one round",
    "planned, from a plate with tabs",
    "engraved",
    "inches",
)
"""Of `tests.toolpath.programs`, those of which programs are damaged."""


@cache
def product(scene: str) -> Product:
    """The disc of a scene."""
    return Design(parse_scene(scene)).disc


@cache
def written(kind: str, scene: str) -> bytes:
    """The good file."""
    return WRITERS[kind].write(product(scene), TOLERANCE).data


# Programs -----------------------------------------------------------------------------------------


def operations_of(lines: list[str]) -> list[tuple[int, int]]:
    """Where the blocks of each operation begin and end."""
    marks = [k for k, line in enumerate(lines) if re.search(r"[(;]? ?operation ", line)]
    marks = marks or [len(lines) // 4]
    return [(a, b) for a, b in pairwise([*marks, len(lines)]) if b - a > 3]


WORDS: Final = {"X": 2.0 * TOLERANCE, "Y": -2.0 * TOLERANCE, "Z": 0.03, "I": 0.05, "T": 1.0}
"""By how much the value of each word is changed."""


def changed(line: str, word: str) -> str:
    """The line with one of its numbers changed."""

    def other(found: re.Match[str]) -> str:
        value = float(found[2])
        new = value + WORDS[word]
        digits = len(found[2].partition(".")[2])
        return f"{found[1]}{new:.{max(digits, 3)}f}" if digits else f"{found[1]}{new:g}"

    return re.sub(rf"(?<![A-Z])({word})([-+]?\d+\.?\d*)", other, line, count=1)


def program_damages(lines: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Of each operation a word of each kind in its middle, a block left out, and two swapped."""
    for number, (begin, end) in enumerate(operations_of(lines)):
        for word in WORDS:
            there = [
                k for k in range(begin, end)
                if re.search(rf"(?<![A-Z]){word}[-+\d]", lines[k]) and lines[k][0] != "("
            ]  # fmt: skip
            if not there or (number + len(word) + ord(word)) % 3:
                continue
            place = there[len(there) // 2]
            after = [*lines[:place], changed(lines[place], word), *lines[place + 1 :]]
            yield f"{word} of operation {number}", after
        place = begin + (2 * (end - begin)) // 3
        yield f"a block of operation {number} left out", [*lines[:place], *lines[place + 1 :]]


HEADS: Final[dict[str, tuple[str, str]]] = {
    "inches": ("G21", "G20"),
    "another plane": ("G17", "G18"),
    "increments": ("G90", "G91"),
    "blending": ("G61", "G64 P0.2"),
    "bound blending": ("G61", "G64 P0.001"),
    "no blending stated": ("G61", "G64"),
    "a tolerance": ("tolerance 0.01 mm", "tolerance 0.02 mm"),
    "no compensation": ("G41", "G40"),
    "the other side": ("G41", "G42"),
    "the offset of another tool": (" D2", " D1"),
    "an offset that is stated larger": ("at most 0.", "at most 1."),
    "no change of tools": ("M6", ""),
    "no spindle": ("M3", ""),
    "no end": ("M2", ""),
    "a second side": ("(camgeo ", "(second side: the work is turned over)\n(camgeo "),
    "a path of nobody": ("M5", "G1 X9 Y9 F100\nG2 X9 Y9 I-9 J-9\nM5"),
}
"""Changes of a whole program: what stands instead of the first of some words."""

HARMLESS: Final[dict[str, Callable[[str], str]]] = {
    "spaces": lambda text: re.sub(r"\n(G\d+) ", r"\n\1   ", text),
    "small letters": lambda text: re.sub(r"(?m)^G.*$", lambda each: each[0].lower(), text),
    "zeros": lambda text: re.sub(r"(?m)^G([0-3]) ", r"G0\1 ", text),
    "numbers of blocks": lambda text: re.sub(r"(?m)^(G[0-3] )", r"N10 \1", text),
    "empty lines": lambda text: text.replace("\nG1 ", "\n\nG1 "),
    "ends of lines": lambda text: text.replace("\n", "\r\n"),
}
"""Changes after which the machine does the same."""


# Drawings, solids ---------------------------------------------------------------------------------


def of_numbers(text: str, pattern: str, step: float, count: int) -> Iterator[tuple[str, str]]:
    """`count` numbers of a text, evenly chosen, each moved by a `step`: the second group of the
    `pattern`; the first is what is before it.
    """
    found = list(re.finditer(pattern, text))
    for k in np.unique(np.linspace(0, len(found) - 1, min(count, len(found))).astype(int)).tolist():
        each = found[k]
        moved = repr(float(each[2]) + step)
        yield f"number {k}", text[: each.start(2)] + moved + text[each.end(2) :]


def drawing_damages(text: str) -> Iterator[tuple[str, str]]:
    """Coordinates, bulges, knots and all other numbers of entities."""
    head, mark, entities = text.partition("\nENTITIES\n")
    entities, end, tail = entities.partition("\nENDSEC\n")
    tail = end + tail
    for code, step, count in (
        ("10", 2.0 * TOLERANCE, 3), ("20", -2.0 * TOLERANCE, 2), ("40", 0.02, 3), ("42", 0.01, 2),
        ("11", 0.05, 2), ("50", 1.0, 2), ("51", 1.0, 2), ("30", 0.02, 1), ("70", 1.0, 3),
        ("74", 1.0, 1), ("90", 1.0, 1), ("62", 1.0, 1),
    ):  # fmt: skip
        for name, after in of_numbers(entities, rf"(\n *{code}\n *)(-?\d+\.?[\de-]*)", step, count):
            whole = re.sub(rf"(\n *{code}\n *-?\d+)\.0(\n)", r"\1\2", after) if code in (
                "70", "74", "90", "62") else after  # fmt: skip
            yield f"group {code}, {name}", head + mark + whole + tail
    for name, old, new in (
        ("a unit", "$INSUNITS\n 70\n4", "$INSUNITS\n 70\n1"),
        ("no unit", "$INSUNITS\n 70\n4", "$INSUNITS\n 70\n0"),
        ("a layer that is frozen", "\nCUT\n 70\n0", "\nCUT\n 70\n1"),
        ("a layer of another name", "\nCUT\n", "\nCUTS\n"),
        ("no entities", "LWPOLYLINE", "LWPOLYLIN"),
    ):
        if old in text:
            yield name, text.replace(old, new)


def svg_damages(text: str) -> Iterator[tuple[str, str]]:
    """Numbers of paths, the size, and what is drawn."""
    yield from of_numbers(text, r"([ ,A-Z])(-?\d+\.\d+)", 2.0 * TOLERANCE, 6)
    for old, new in (("mm", "in"), ("viewBox", "viewbox"), ("<path", "<line"), ("Z", "")):
        yield f"{new or 'nothing'} for {old}", text.replace(old, new)


def step_damages(text: str) -> Iterator[tuple[str, str]]:
    """Numbers of points, directions, radii, knots; flags; references; texts."""
    kinds = re.findall(r"#\d+ ?= ?([A-Z_]+)\(", text)
    for kind in dict.fromkeys(kinds):
        lines = rf"(#\d+ ?= ?{kind}\([^;]*?[(,])"
        yield from (
            (f"{kind}, {name}", after)
            for name, after in of_numbers(text, rf"{lines}(-?\d+\.\d*(?:E-?\d+)?)(?=[,)])", 0.02, 2)
        )
        for flag, other in ((".T.", ".F."), (".F.", ".T.")):
            found = [
                each for each in re.finditer(rf"#\d+ ?= ?{kind}\([^;]*", text) if flag in each[0]
            ]
            for each in found[len(found) // 2 :][:1]:
                after = each[0].replace(flag, other, 1)
                yield f"{kind} {flag} {each.start()}", text.replace(each[0], after)
        found = list(re.finditer(rf"#\d+ ?= ?{kind}\([^;]*?#(\d+)[^;]*", text))
        for each in found[len(found) // 2 :][:1]:
            a, b = each.span(1)
            yield f"{kind}, a reference", text[:a] + str(int(each[1]) + 1) + text[b:]
        texts = re.search(rf"#\d+ ?= ?{kind}\([^;]*?'([^';]+)'", text)
        if texts:
            a, b = texts.span(1)
            yield f"{kind}, a text", text[:a] + "other" + text[b:]


def mesh_damages(text: str) -> Iterator[tuple[str, str]]:
    """Coordinates of vertices and corners of triangles of a model."""
    for letter, step in (("x", 0.02), ("y", -0.02), ("z", 0.02), ("z", 0.005)):
        for name, after in of_numbers(text, rf'(<vertex [^>]*{letter}=")([-\d.e]+)', step, 2):
            yield f"{letter} by {step}, {name}", after
    triangles = re.findall(r"<triangle [^>]*>", text)
    for k in range(3, len(triangles), len(triangles) // 2):
        yield f"no triangle {k}", text.replace(triangles[k], "", 1)
        corners = re.findall(r"\d+(?=\")", triangles[k])
        turned = triangles[k].replace(f'v1="{corners[0]}" v2="{corners[1]}"',
                                      f'v1="{corners[1]}" v2="{corners[0]}"')  # fmt: skip
        yield f"triangle {k} turned", text.replace(triangles[k], turned, 1)
    for letter, factor in (("x", 1.0005), ("x", -1.0), ("z", 1.005)):
        yield f"{factor} times {letter}", _scaled(text, letter, factor)


def _scaled(text: str, letter: str, factor: float) -> str:
    return re.sub(
        rf' {letter}="([^"]+)"', lambda each: f' {letter}="{float(each[1]) * factor!r}"', text
    )


def facet_damages(data: bytes) -> Iterator[tuple[str, bytes]]:
    """Fields of facets of an STL, and its length."""
    good = np.frombuffer(data, FACET, offset=PREFIX)
    for k in range(2, len(good), len(good) // 2):
        for field, place, by in (
            ("corners", (1, 0), 0.02), ("corners", (2, 2), 0.02), ("normal", (0,), 0.01),
            ("normal", (2,), 1e-3),
        ):  # fmt: skip
            facets = good.copy()
            facets[field][(k, *place)] += by
            yield f"{field} {place} of facet {k}", data[:PREFIX] + facets.tobytes()
        yield f"no facet {k}", _counted(data, np.delete(good, k))
        facets = good.copy()
        facets["corners"][k] = facets["corners"][k][::-1]
        facets["normal"][k] *= -1.0
        yield f"facet {k} turned", data[:PREFIX] + facets.tobytes()
    yield "a byte more", data + b"\0"


def _counted(data: bytes, facets: Any) -> bytes:
    body: bytes = facets.tobytes()
    return data[: PREFIX - 4] + len(facets).to_bytes(4, "little") + body


# All ----------------------------------------------------------------------------------------------


Case = tuple[str, bytes]
"""What is done to a file, nothing if it is "", and what it is then."""


def drawings(entity: str) -> Iterator[Case]:
    """A drawing of the groove."""
    good = written("dxf", drawn(entity))
    yield "", good
    damages = list(drawing_damages(good.decode()))
    for name, text in damages[::9] if entity == "polyline" else damages:
        yield name, text.encode()


def texts(kind: str, scene: str) -> Iterator[Case]:
    """An SVG or a STEP file."""
    good = written(kind, scene)
    yield "", good
    damages = list((svg_damages if kind == "svg" else step_damages)(good.decode()))
    for name, text in damages[:: 2 if scene == SOLID else 1]:
        yield name, text.encode()


def packages() -> Iterator[Case]:
    """A 3MF package of the solid."""
    good = written("3mf", SOLID)
    yield "", good
    models: list[str] = []

    def kept(path: str, content: str) -> str:
        models.extend([content] if path == MODEL_PATH else [])
        return content

    repacked(good, kept)
    for name, text in mesh_damages(models[0]):
        yield name, repacked(good, partial(_model, text))


def _model(text: str, path: str, content: str) -> str:
    return text if path == MODEL_PATH else content


def facets() -> Iterator[Case]:
    """An STL of the solid."""
    good = written("stl", SOLID)
    yield "", good
    yield from facet_damages(good)


def milled(name: str) -> Iterator[Case]:
    """A program."""
    text = written("gcode", programs.SCENES[name]).decode()
    yield "", text.encode()
    for what, after in program_damages(text.split("\n")):
        yield what, "\n".join(after).encode()
    if name in PROGRAMS[:2]:
        for what, (old, new) in HEADS.items():
            if old in text:
                yield what, text.replace(old, new, 1).encode()


FILES: Final[dict[str, tuple[str, str, Callable[[], Iterator[Case]]]]] = {
    **{
        f"dxf of {entity}": ("dxf", drawn(entity), partial(drawings, entity))
        for entity in ("arcs", "spline", "lines-and-arcs", "polyline")
    },
    "svg": ("svg", GROOVE, partial(texts, "svg", GROOVE)),
    "step of the solid": ("step", SOLID, partial(texts, "step", SOLID)),
    "step of the groove": ("step", GROOVE, partial(texts, "step", GROOVE)),
    "3mf": ("3mf", SOLID, packages),
    "stl": ("stl", SOLID, facets),
    **{name: ("gcode", programs.SCENES[name], partial(milled, name)) for name in PROGRAMS},
}
"""Format, scene, and the good file with what is done to it."""


def record(check: Check) -> dict[str, Any]:
    """A check as plain data; what is empty is left out."""
    found = {key: value for key, value in asdict(check).items() if value not in ("", None)}
    return found | {"ok": check.ok}


def said(name: str, data: bytes) -> list[dict[str, Any]]:
    """All checks of a file."""
    kind, scene, _ = FILES[name]
    verifier = VERIFIERS[WRITERS[kind].format.name]
    if damage := verifier.origin(data).damage:
        return [record(Check("file", ok=False, note=damage))]
    checks = verifier.checks(product(scene), data, Reading("file"), TOLERANCE)
    return [record(each) for each in checks]


def document(name: str) -> dict[str, Any]:
    """Of the good file all checks; of each damaged one those that are other ones, and the number of
    those that are not made.

    Of a program also what it does to the blank, line by line.
    """
    kind, scene, cases = FILES[name]
    found: dict[str, Any] = {}
    good: list[dict[str, Any]] = []
    for number, (what, data) in enumerate(cases()):
        checks = said(name, data)
        good = checks if not what else good
        row: dict[str, Any] = {
            "other": [each for each in checks if not what or not _among(each, good)]
        }
        row["not made"] = len({_of(each) for each in good} - {_of(each) for each in checks})
        if kind == "gcode" and number % 4 == 0:
            machine = load(product(scene).milled.gcode.machine)
            lines = VERIFIER.worked(product(scene), data, machine)
            row["lines"] = [asdict(each) for each in lines]
        found[what] = row
    return found


def _among(check: dict[str, Any], good: list[dict[str, Any]]) -> bool:
    """Whether one of the good ones says the same, up to rounding."""
    return any(
        kept.same(one, other)
        for one, other in ((str(check), str(each)) for each in good if _of(each) == _of(check))
    )


def _of(check: dict[str, Any]) -> tuple[str, str]:
    return check["name"], check.get("of", "")
