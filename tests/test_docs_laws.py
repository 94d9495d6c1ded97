"""docs/laws.md describes the laws correctly: its tables, formulas and scenes are tested."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.kinematics.laws import ALIASES, FAMILIES, make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import TASKS
from camgeo.kinematics.plan import Dwell, SplineMove
from camgeo.scene.scene import parse_scene
from tests.long_form import LONG
from tests.pages import page_maker

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "laws.md").read_text(encoding="utf-8")

LARGEST_PICTURE = 60_000
"""bytes"""

MISPRINTED = 87
SHIFTED = 69
"""Misprinted cells of the guideline's tables, and those of one column that the page sums up."""


def maker() -> Any:
    """The module docs/laws_page.py."""
    return page_maker("laws_page")


def sections() -> dict[str, str]:
    """Text below each heading, with the headings of lower level in it."""
    found = {}
    heads = list(re.finditer(r"^(#{1,3}) (.*)$", PAGE, flags=re.MULTILINE))
    for number, head in enumerate(heads):
        level = len(head[1])
        ends = (later.start() for later in heads[number + 1 :] if len(later[1]) <= level)
        found[head[2]] = PAGE[head.end() : next(ends, len(PAGE))]
    return found


SECTIONS = sections()


def fenced(text: str, kind: str) -> list[str]:
    return re.findall(rf"^```{kind}\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)


# Page and pictures ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", FAMILIES)
def test_every_family_has_its_section_with_all_its_tasks(name: str) -> None:
    text = SECTIONS[name]
    for task in FAMILIES[name].tasks:
        assert re.search(rf"^\| {task} \|", text, flags=re.MULTILINE)
    assert "**Use**" in text
    assert "**Not**" in text
    picture = f"images/laws/{name}.svg"
    assert f"]({picture})" in text
    assert (DOCS / picture).stat().st_size < LARGEST_PICTURE


def test_no_text_is_left_over() -> None:
    module = maker()
    known = {*FAMILIES, *module.BEFORE, *module.AFTER}
    assert {file.stem for file in (DOCS / "laws").iterdir()} == known


def test_the_table_of_tasks_names_every_family_at_its_tasks() -> None:
    rows = [
        line for line in SECTIONS["Conventions"].splitlines() if re.match(r"\| \*\*\w\*\*", line)
    ]
    cells = {
        f"{start}-{end}": cell
        for start, row in zip("RGUB", rows, strict=True)
        for end, cell in zip("RGUB", row.strip("| ").split(" | ")[1:], strict=True)
    }
    for name, family in FAMILIES.items():
        if name in ("polynomial-5", "polynomial-7", "polynomial"):
            continue
        for task in TASKS:
            assert (f"`{name}`" in cells[task]) == (task in family.tasks)


def test_the_aliases_are_listed() -> None:
    assert all(f"`{alias}`" in SECTIONS[name] for alias, name in ALIASES.items())


def test_the_misprints_are_all_there() -> None:
    rows = re.findall(r"^\|.*\| 0\.\d{3} \|.*$", SECTIONS["Value tables"], flags=re.MULTILINE)
    assert len(rows) + SHIFTED == MISPRINTED


# Formulas -------------------------------------------------------------------------------------

TOKEN = re.compile(r"\d+(?:\.\d+)?|[^\W\d]\w*\*?'*|\S")
"""A number, a name (C_a* and f'' among them), or a sign."""

TOLERANCE = 1e-12
"""Of the largest value: a page's formula, evaluated as it stands, sums terms a few hundred times
its result, each rounded to 1e-16; a misprint of one unit in four digits shows as 1e-4."""

SHARES = (0.07, 0.31, 0.5, 0.83) if LONG else (0.31, 0.83)
"""Places inside each stretch of z."""


def python(text: str, names: Mapping[str, Any]) -> str:
    """A formula of the page in Python: products without sign, ^, primes and stars."""
    out: list[str] = []
    before = ""
    for token in TOKEN.findall(text):
        operand = bool(re.match(r"\w|\(", token))
        function = callable(names.get(before))
        if operand and re.match(r"\w|\)", before[:1]) and not (function and token == "("):
            out.append("*")
        out.append(
            "**" if token == "^" else spelled(token) if re.match(r"[^\W\d]", token) else token
        )
        before = token
    return " ".join(out)


def spelled(name: str) -> str:
    return name.replace("*", "_star").replace("'", "_prime")


def value(text: str, names: Mapping[str, Any]) -> Any:
    local = {spelled(name): found for name, found in names.items()}
    return eval(python(text, names), {"__builtins__": {}}, local)


def formula_values(
    lines: list[str], z: float, given: Mapping[str, Any]
) -> tuple[float, float, float, float]:
    """f, f', f'', f''' at z by the lines of a block."""
    names: dict[str, Any] = {"π": math.pi, "sin": math.sin, "cos": math.cos, **given, "z": z}
    inside = True
    found: dict[str, float] = {}
    for line in lines:
        if stretch := re.fullmatch(r"(.*) <= z <= ([^:]*)(: mirror image)?", line):
            inside = value(stretch[1], names) <= z <= value(stretch[2], names)
            if inside and stretch[3]:
                f, f1, f2, f3 = formula_values(lines, 1.0 - z, given)
                return 1.0 - f, f1, -f2, f3
        elif inside:
            name, _, formula = line.partition(" = ")
            names[name.strip()] = found[name.strip()] = value(formula, names)
    return found["f"], found["f'"], found["f''"], found["f'''"]


def stretches(lines: list[str], given: Mapping[str, Any]) -> list[tuple[float, float]]:
    """The borders of the block's stretches."""
    names: dict[str, Any] = {"π": math.pi, "sin": math.sin, "cos": math.cos, **given}
    found = []
    for line in lines:
        if stretch := re.fullmatch(r"(.*) <= z <= ([^:]*)(: mirror image)?", line):
            found.append((float(value(stretch[1], names)), float(value(stretch[2], names))))
        elif not line.startswith(" ") and " = " in line and not re.search(r"\bz\b", line):
            name, _, formula = line.partition(" = ")
            names[name.strip()] = value(formula, names)
    return found


TINY = 1e-9
"""A stretch no longer than this is only rounding."""

Block = tuple[str, str, list[str], bool]
"""Family, task, lines, and whether the law is the mirror image of what they say."""


def blocks() -> Iterator[Block]:
    for name in FAMILIES:
        for text in fenced(SECTIONS[name], "text"):
            head, *lines = text.rstrip("\n").split("\n")
            if not re.fullmatch(r"(\w-\w(, )?)+:", head):
                continue
            images = [line for line in lines if re.match(r"\w-\w: mirror", line)]
            lines = [line for line in lines if line not in images]
            for task in head.rstrip(":").split(", "):
                yield name, task, lines, False
            yield from ((name, image[:3], lines, True) for image in images)


BLOCKS = list(blocks())

VALUES = {
    "inflection": (0.3, 0.5, 0.8),
    "v0": (0.4, 1.7, -0.5),
    "v1": (2.0, 0.7),
    "a0": (3.0,),
    "a1": (-4.0, 2.5),
    "j0": (5.0,),
    "j1": (-7.0,),
    "sine": (0.25, 0.1),
    "cosine": (0.75, 0.4),
    "curved": (1.0, 0.6),
}
"""Values of the parameters at which formulas are compared."""

WRITTEN = {"inflection": "λ", "curved": "c", "sine": "b", "cosine": "d"}
"""Names of the parameters on the page."""


def parameter_sets(block: Block) -> Iterator[dict[str, float]]:
    name, task, lines, _ = block
    taken = FAMILIES[name].parameters[task]
    free = [
        key
        for key in taken
        if (key != "inflection" or any("λ" in line for line in lines))
        # A turn's acceleration follows from the inflection point.
        and not (key[0] == "a" and "inflection" in taken)
    ]
    for values in itertools.product(*(VALUES[key] for key in free)):
        given = dict(zip(free, values, strict=True))
        if given.get("sine", 0.0) + given.get("cosine", 0.0) <= 1.0:
            yield given


def test_every_family_and_task_has_a_formula() -> None:
    found = {(name, task) for name, task, _, _ in BLOCKS}
    assert found >= {(name, task) for name, family in FAMILIES.items() for task in family.tasks}


def compare(law: Law, lines: list[str], names: Mapping[str, Any], mirrored: bool = False) -> None:
    rows = []
    for start, end in stretches(lines, names):
        for z in (start + share * (end - start) for share in SHARES if end - start > TINY):
            f, f1, f2, f3 = formula_values(lines, z, names)
            image = (1.0 - z, 1.0 - f, f1, -f2, f3)
            rows.append(image if mirrored else (z, f, f1, f2, f3))
    z, *reported = np.array(rows).T
    for one, other in zip(reported, law(z), strict=True):
        assert np.max(np.abs(one - other)) <= TOLERANCE * max(1.0, float(np.max(np.abs(other))))


@pytest.mark.parametrize("block", BLOCKS, ids=[f"{b[0]}-{b[1]}-{n}" for n, b in enumerate(BLOCKS)])
def test_the_formulas_are_those_of_the_law(block: Block) -> None:
    name, task, lines, mirrored = block
    for given in parameter_sets(block):
        names = {"v0": 0.0, "a0": 0.0, "j0": 0.0, "v1": 0.0, "a1": 0.0, "j1": 0.0}
        names |= {WRITTEN.get(key, key): number for key, number in given.items()}
        if mirrored and "v1" in given:
            names |= {"v0": given["v1"], "v1": 0.0}
        compare(make_law(name, task, **given), lines, names, mirrored)


@pytest.mark.parametrize("name", ["quadratic-parabola", "polynomial-345", "modified-sine"])
@pytest.mark.parametrize("inflection", [0.2, 0.5, 0.7])
def test_the_shift_of_the_inflection_point_is_as_stated(name: str, inflection: float) -> None:
    (text,) = (b for b in fenced(SECTIONS["Conventions"], "text") if b.startswith("R-R:"))
    base = make_law(name)

    def order(k: int) -> Callable[[float], float]:
        return lambda z: float(base(np.array([z]))[k][0])

    names: dict[str, Any] = {"F" + "'" * k: order(k) for k in range(4)}
    compare(
        make_law(name, inflection=inflection), text.split("\n")[1:-1], {**names, "λ": inflection}
    )


def test_a_misprint_is_seen() -> None:
    name, task, lines, _ = next(b for b in BLOCKS if b[0] == "modified-sine")
    wrong = [line.replace("9/(4π)", "9.01/(4π)") for line in lines]
    assert wrong != lines
    with pytest.raises(AssertionError):
        compare(make_law(name, task), wrong, {})


# Scenes ---------------------------------------------------------------------------------------

HEAD = """camgeo = 1
name = "laws"

[cam]
rotation = "ccw"

[follower]
kind = "translating-roller"
base_radius = 60
roller_radius = 8

"""

SCENES = [
    (title, text)
    for title in (*FAMILIES, "points", "table", "auto")
    for text in fenced(SECTIONS[title], "toml")
]


@pytest.mark.parametrize(("title", "text"), SCENES, ids=[title for title, _ in SCENES])
def test_the_scenes_can_be_read(title: str, text: str, tmp_path: Path) -> None:
    for rows in fenced(SECTIONS["table"], "csv"):
        (tmp_path / "lift.csv").write_text(rows, encoding="utf-8")
    scene = parse_scene(HEAD + text, str(tmp_path / "laws.toml"))
    moves = [segment for segment in scene.plan.segments if not isinstance(segment, Dwell)]
    if title in FAMILIES:
        assert title in {move.law.name for move in moves if not isinstance(move, SplineMove)}
    elif title in ("points", "table"):
        assert any(isinstance(move, SplineMove) for move in moves)


def test_every_section_has_a_scene() -> None:
    assert {title for title, _ in SCENES} == {*FAMILIES, "points", "table", "auto"}
