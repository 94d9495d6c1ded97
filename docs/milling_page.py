"""Writes docs/milling.md and its pictures: `python docs/milling_page.py`, in a checkout.

The texts are in docs/milling; what `<!-- ... -->` in them asks for is taken from fixtures/milling
and from what camgeo says and writes. A test holds the page to that; the pictures are renewed by
running this and are not compared, for their bytes depend on matplotlib's version too.
"""

from __future__ import annotations

import io
import re
import shutil
import tempfile
import textwrap
from collections.abc import Callable
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Final

from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene

HERE: Final = Path(__file__).parent
PAGE: Final = HERE / "milling.md"
TEXTS: Final = HERE / "milling"
IMAGES: Final = HERE / "images"
SCENES: Final = HERE.parent / "fixtures" / "milling"

NOTE: Final = (
    "<!-- Made from docs/milling, fixtures/milling and the code by docs/milling_page.py. -->\n"
)

PARTS: Final = ("head", "steel", "plywood", "size", "holding", "refused")
"""The texts, in their order."""

PICTURES: Final = {"milling-steel": "steel_plate_cam", "milling-plywood": "plywood_cam"}

COLOURS: Final = 128
"""Of the pictures."""

ASKED: Final = re.compile(r"<!-- (\w+)((?: \S+)*) -->\n")

TABLE: Final = r"^\[+{}\]+.*\n(?:(?!\[).*\n?)*"
"""A table of a scene."""

WIDTH: Final = 100
"""Characters of a line in a quotation; longer ones go on below, indented."""

HOLDING: Final = re.compile(TABLE.format(r"holding(?:\.screw)?"), re.MULTILINE)

JOBS: Final = (
    ("steel_plate_cam", "fixture: a round blank in soft jaws, stated operations, both sides"),
    ("plywood_cam", "tabs: a plate on a router"),
    ("moved_clamps", "clamps: one makes room for a strap through the bore"),
    ("bolt_circle", "screws through three holes of a round blank, whose bore is reamed"),
    ("onion_skin", "onion-skin: plastic on a vacuum table"),
    ("engraved_zero", "fixture: the zero of a cam engraved beside its timing mark"),
    ("groove_flanks", "none is needed: a groove, roughed, and both flanks finished"),
)

REFUSED: Final = (
    ("plywood_cam", "feed = 1800\n", "", "a tool without a feed"),
    ("plywood_cam", "HOLDING", "", "nothing holds what is cut free"),
    ("plywood_cam", "flute_length = 22", "flute_length = 10", "cutting edges that are too short"),
    ("plywood_cam", "bore = 10", "bore = 5.8", "a bore into which the cutter does not fit"),
    ("plywood_cam", '"grbl"', '"grbl"\ncoolant = "mist"', "coolant that the machine lacks"),
    ("steel_plate_cam", 'kind = "drill"\ntool = 4', 'kind = "drill"\ntool = 1', "the wrong tool"),
    ("steel_plate_cam", "retract_height = 3", "retract_height = 0.5", "traverses into the blank"),
    ("moved_clamps", 'until = "rough outline"\n', "", "a clamp that stays where something is cut"),
    ("moved_clamps", "height = 10", "height = 20", "a clamp as high as the traverses"),
)
"""Scene, what is changed in it into what, and what is then wrong."""


def page() -> str:
    """The page's text."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        shutil.copytree(SCENES, Path("fixtures", "milling"))
        text = "".join((TEXTS / f"{part}.md").read_text(encoding="utf-8") for part in PARTS)
        title, _, below = text.partition("\n")
        return f"{title}\n\n{NOTE}{ASKED.sub(_given, below)}"


def _given(asked: re.Match[str]) -> str:
    what, words = asked[1], asked[2].split()
    return GIVERS[what](*words)


def _quoted(language: str, lines: list[str]) -> str:
    return f"```{language}\n" + "\n".join(lines) + "\n```\n"


def _wrapped(line: str) -> list[str]:
    return textwrap.wrap(line, WIDTH, subsequent_indent="    ", break_on_hyphens=False) or [""]


def _text(scene: str) -> str:
    return Path("fixtures", "milling", f"{scene}.toml").read_text(encoding="utf-8")


def said(*words: str) -> tuple[int, list[str]]:
    """The exit code of a command, and the lines that it prints and those on standard error."""
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        code = main(list(words))
    return code, [*out.getvalue().splitlines(), *err.getvalue().splitlines()]


def _command(*words: str) -> str:
    """A command and what it prints."""
    code, lines = said(*words)
    assert code == 0, lines
    shown = [part for line in lines for part in _wrapped(line)]
    return _quoted("text", [f"$ camgeo {' '.join(words)}", *shown])


def _scene(scene: str, *tables: str) -> str:
    """Tables of a scene."""
    found = [
        each[0].strip()
        for table in tables
        for each in re.finditer(TABLE.format(re.escape(table)), _text(scene), re.MULTILINE)
    ]
    return _quoted("toml", "\n\n".join(found).splitlines())


def _tools(name: str) -> str:
    return _quoted("toml", _text(f"tools/{name}").strip().splitlines())


def _path(scene: str) -> str:
    return f"fixtures/milling/{scene}.toml"


def _build(scene: str) -> str:
    return _command("build", _path(scene), "-o", f"out/{scene}")


def _setup(scene: str) -> str:
    return _command("setup", _path(scene))


def _program(scene: str) -> list[str]:
    program, *_ = sorted(Path("out").glob(f"{scene}/*.n*c"), key=lambda path: len(path.name))
    return program.read_text(encoding="ascii").splitlines()


def _head(scene: str, count: str) -> str:
    """The first lines of a program that `_build` has written."""
    return _quoted("text", [*_program(scene)[: int(count)], "..."])


def _second(scene: str, count: str) -> str:
    """The first lines of that of the second side."""
    (program,) = Path("out", scene).glob("*-second-side.n*c")
    lines = program.read_text(encoding="ascii").splitlines()
    return _quoted("text", [*lines[: int(count)], "..."])


def _operation(scene: str, name: str, count: str) -> str:
    """The first lines of one of its operations."""
    lines = _program(scene)
    start = lines.index(f"(operation {name})")
    return _quoted("text", [*lines[start : start + int(count)], "..."])


def _jobs() -> str:
    rows = [f"| `{scene}.toml` | {what} |\n" for scene, what in JOBS]
    return "| scene | holding and what else |\n|---|---|\n" + "".join(rows)


def _refused() -> str:
    """What camgeo says of scenes in which something is wrong."""
    rows = []
    for scene, old, new, wrong in REFUSED:
        text = _text(scene)
        changed = HOLDING.sub(new, text) if old == "HOLDING" else text.replace(old, new, 1)
        assert changed != text, old
        Path(_path("changed")).write_text(changed, encoding="utf-8")
        code, lines = said("check", _path("changed"))
        if code == 0:
            code, lines = said("build", _path("changed"), "-o", "refused")
        assert code in (1, 2), lines
        rows.append(f"- {wrong[0].upper()}{wrong[1:]}: `{_fault(lines)}`\n")
    return "".join(rows)


def _fault(lines: list[str]) -> str:
    """The fault in what camgeo says, without where it is."""
    told = [each for each in lines if re.match(r"INVALID|BROKEN|  \S", each)]
    place = r"^(?:(?:INVALID|BROKEN) +[\w-]+)? +(?:\S+\.toml: )?(?:line \d+: )?"
    return re.sub(place, "", told[-1])


GIVERS: Final[dict[str, Callable[..., str]]] = {
    "build": _build,
    "head": _head,
    "jobs": _jobs,
    "program": _operation,
    "refused": _refused,
    "scene": _scene,
    "second": _second,
    "setup": _setup,
    "tools": _tools,
}
"""What the texts may ask for."""


def write() -> None:
    """Write the page and its pictures."""
    from PIL import Image

    from camgeo.pictures.plots import stacked
    from camgeo_export.plots import render

    PAGE.write_text(page(), encoding="utf-8")
    for name, scene in PICTURES.items():
        disc = Design(load_scene(str(SCENES / f"{scene}.toml"))).disc
        picture = Image.open(io.BytesIO(render(stacked(disc, ["backplot"]), ".png")))
        # Thousands of shades between few colours: a third of the bytes without them.
        few = picture.convert("RGB").quantize(COLOURS, Image.Quantize.FASTOCTREE)
        few.save(IMAGES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    write()
