"""Writes docs/mechanisms.md and its pictures: `python docs/mechanisms_page.py`.

The texts are in docs/mechanisms, one file a mechanism. `<!-- picture -->` becomes the picture of
the mechanism's scene, what the scene says of follower and linkage, and what `camgeo check` finds of
them; `<!-- table -->` the list of all. A test holds the page to the texts, scenes and code; the
pictures are renewed by running this and are not compared, for their bytes depend on matplotlib's
version too.
"""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import finding_lines
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene

HERE: Final = Path(__file__).parent
PAGE: Final = HERE / "mechanisms.md"
TEXTS: Final = HERE / "mechanisms"
IMAGES: Final = HERE / "images"
SCENES: Final = HERE.parent / "fixtures" / "scenes"

NOTE: Final = (
    "<!-- Made from docs/mechanisms, fixtures/scenes and the code by docs/mechanisms_page.py. -->\n"
)

MECHANISMS: Final = {
    "translating-roller": "plate_translating",
    "oscillating-roller": "shuttle",
    "knife-edge": "knife_edge",
    "translating-flat": "tappet",
    "oscillating-flat": "flat_rocker",
    "groove": "groove_clearance",
    "conjugate-carriage": "conjugate_carriage",
    "conjugate-lever": "conjugate_lever",
    "constant-breadth": "constant_breadth",
    "slider-crank": "setzhub",
    "slider-driven-crank": "crank_slider",
    "four-bar": "four_bar",
}
"""Scene of each mechanism, by the name that `camgeo new` has for it."""

ROLLER: Final = ("transmission-angle", "radius-ratio-inner")

FLAT: Final = ("convexity", "face-length")

PAIR: Final = ("form-closure", "closing-error")

LINKAGE: Final = ("dead-centre", "linkage-transmission-angle", "linkage-back-angle")

FINDINGS: Final = {
    "translating-roller": ROLLER,
    "oscillating-roller": ROLLER,
    "knife-edge": ("transmission-angle", "tangent-closure"),
    "translating-flat": FLAT,
    "oscillating-flat": ("transmission-angle", *FLAT),
    "groove": (*ROLLER, "radius-ratio-outer", "side-clearance"),
    "conjugate-carriage": PAIR,
    "conjugate-lever": PAIR,
    "constant-breadth": (*FLAT, "closing-error"),
    "slider-crank": (*ROLLER, *LINKAGE),
    "slider-driven-crank": (*ROLLER, *LINKAGE),
    "four-bar": (*ROLLER, *LINKAGE),
}
"""Findings of each that the page shows."""

LATER: Final = ("slotted-lever",)
"""Texts after those of the mechanisms."""

TABLES: Final = re.compile(r"^\[(?:follower|linkage)[^\]]*\]\n(?:(?!\[).*\n)*", re.MULTILINE)
"""The tables of a scene that define the mechanism."""


def page() -> str:
    """The page's text."""
    head, *rest = (section(name) for name in ("conventions", *MECHANISMS, *LATER))
    title, _, below = head.partition("\n")
    return f"{title}\n\n{NOTE}{below}" + "".join(f"\n{text}" for text in rest)


def section(name: str) -> str:
    """A text with what is put in."""
    text = (TEXTS / f"{name}.md").read_text(encoding="utf-8")
    text = text.replace("<!-- table -->\n", overview())
    return text.replace("<!-- picture -->\n", _shown(name) if name in MECHANISMS else "")


def overview() -> str:
    """A row for each mechanism."""
    rows = []
    for name, scene in MECHANISMS.items():
        tables = tomllib.loads(_text(scene))
        kinds = [tables.get(table, {}).get("kind", "none") for table in ("follower", "linkage")]
        rows.append(
            f"| [{name}](#{name}) | `fixtures/scenes/{scene}.toml` | {' | '.join(kinds)} |\n"
        )
    return "| `camgeo new` | scene | follower | linkage |\n|---|---|---|---|\n" + "".join(rows)


def _text(scene: str) -> str:
    return (SCENES / f"{scene}.toml").read_text(encoding="utf-8")


@cache
def design(scene: str) -> Design:
    """The scene of that name."""
    return Design(load_scene(str(SCENES / f"{scene}.toml")))


def picture(name: str) -> Path:
    """The file of a mechanism's picture."""
    return IMAGES / f"mechanism-{name}.png"


def _shown(name: str) -> str:
    """Picture, tables of the scene, findings."""
    scene = MECHANISMS[name]
    tables = "\n".join(each.strip() for each in TABLES.findall(_text(scene)))
    found = {finding.name: finding for finding in design(scene).findings}
    lines = finding_lines(tuple(found[each] for each in FINDINGS[name]))
    return (
        f"![{name}: the mechanism at cam angle 0 and at the far position]"
        f"(images/{picture(name).name})\n\n"
        f"```toml\n{tables}\n```\n\n"
        f"```text\n$ camgeo check fixtures/scenes/{scene}.toml\n" + "\n".join(lines) + "\n```\n"
    )


def write() -> None:
    """Write the page and its pictures."""
    from camgeo.pictures.plots import stacked
    from camgeo_export.plots import render

    PAGE.write_text(page(), encoding="utf-8")
    for name, scene in MECHANISMS.items():
        picture(name).write_bytes(render(stacked(design(scene).disc, ["mechanism"]), ".png"))


if __name__ == "__main__":
    write()
