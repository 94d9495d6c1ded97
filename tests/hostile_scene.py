"""A scene in which every text that is free stands for markup, and what a page may make of it."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from typing import Any, Final

from camgeo.design.design import Design
from camgeo.scene.scene import Scene

HOSTILE: Final = (
    "</script><script>alert(1)</script>",
    "<!--<script>",
    "</style><img src=x onerror=alert(1)>",
    '"><a href="javascript:alert(1)">x</a>',
    "' onload='alert(1)",
    "javascript:alert(1)",
    "&lt;b&gt;&#60;i&#62; $x$ \u2028",
)

ALL_AT_ONCE: Final = '"><script>alert(1)</script><a href="javascript:x">'
"""What ends an attribute, a script and an element, no longer than any text may be."""

FORBIDDEN: Final = frozenset(
    ["a", "base", "comment", "embed", "form", "iframe", "link", "object", "script", "style", "svg"]
)
"""Elements that load, run or lead away."""

PICTURE: Final = "data:image/png;base64,"

ATTRIBUTES: Final = frozenset({"alt", "scope", "src", "style", "tabindex", "width"})

SHEET: Final = (
    "owner", "number", "revision", "title", "creator", "approver", "document_type", "material",
    "hardness", "general_tolerances", "edges", "surface", "flank_surface",
)  # fmt: skip
"""Keys of `[drawing]` that hold any text."""


def hostile_design(text: str, folder: Path) -> Design:
    """A small plate cam of which all free texts contain `text`.

    Names of files have it without slashes, which no such name may have.
    """
    named = text.replace("/", " ")
    loads, speeds = f"{named}.csv", f"{named} turns.csv"
    (folder / loads).write_text("phi,force\n0,20\n180,30\n360,20\n", "utf-8")
    (folder / speeds).write_text("t,phi\n0,0\n0.25,90\n0.5,180\n0.75,270\n1,360\n", "utf-8")
    values: dict[str, Any] = {
        "camgeo": 1,
        "name": "hostile",
        "cam": {"rotation": "ccw", "speed_curve": speeds},
        "follower": {"kind": "translating-roller", "base_radius": 30, "roller_radius": 5},
        "motion": [
            {"dwell": 120},
            {"law": "polynomial-345", "span": 120, "to": 5},
            {"law": "polynomial-345", "span": 120, "to": 0},
        ],
        "part": {
            "thickness": 5,
            "bore": 10,
            "engraving": [{"text": text, "height": 1, "depth": 0.1, "radius": 22, "angle": 90}],
        },
        "effects": {"inertia": {"mass": 1}, "load": {"file": loads}},
        "drawing": dict.fromkeys(SHEET, text),
        "stock": {"shape": "round", "diameter": 90, "bore": 10},
        "tool": [
            {
                "number": 1, "name": text, "diameter": 8, "flute_length": 20, "feed": 500,
                "spindle_speed": 6000, "plunge_feed": 150, "stepdown": 2.5, "stepover": 2.4,
            }
        ],
        "holding": {
            "kind": "fixture",
            "through": 0.4,
            "clamp": [{"place": [-80, 0], "length": 9, "width": 9, "height": 3, "since": text}],
        },
        "operation": [
            {"kind": "rough", "tool": 1, "boundary": "outline", "name": "first"},
            {
                "kind": "finish", "tool": 1, "boundary": "outline", "name": text, "note": text,
                "stop": text,
            },
        ],
    }  # fmt: skip
    return Design(Scene(values, folder=folder))


class Page(HTMLParser):
    """Elements with their attributes, and texts, of HTML."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.texts.append(data)

    def handle_comment(self, data: str) -> None:
        self.elements.append(("comment", {}))

    @property
    def outline(self) -> list[tuple[str, list[str]]]:
        """Elements, each with the names of its attributes, in their order."""
        return [(tag, [*attributes]) for tag, attributes in self.elements]


def harmless(page: Page) -> bool:
    """Whether HTML has only elements that show something, and no picture but those in it."""
    return all(
        tag not in FORBIDDEN
        and attributes.keys() <= ATTRIBUTES
        and (tag == "img") == ("src" in attributes)
        and (attributes.get("src") or PICTURE).startswith(PICTURE)
        for tag, attributes in page.elements
    )
