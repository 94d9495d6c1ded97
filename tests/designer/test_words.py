"""The page of the designer has its words in one catalogue, and makes no text into markup."""

from __future__ import annotations

import re
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "export" / "camgeo_export" / "browser" / "src" / "designer"

CATALOGUE = (FOLDER / "strings.ts").read_text("utf-8")

OTHERS = {
    path.name: path.read_text("utf-8")
    for path in (*FOLDER.glob("*.ts"), FOLDER.with_name("dom.ts"))
}
del OTHERS["strings.ts"]

AT_RUN_TIME = ("plan.", "view.", "busy.", "size.")
"""Keys that the page puts together."""


def test_each_word_of_the_catalogue_is_said() -> None:
    words, _, use = CATALOGUE.partition("export const PLAYER")
    keys = re.findall(r'^  "([a-z]+\.[\w-]+)":', words, re.MULTILINE)
    assert len(keys) > 100
    text = "".join((use, *OTHERS.values()))
    assert not [key for key in keys if f'"{key}"' not in text and not key.startswith(AT_RUN_TIME)]


def test_no_words_stand_outside_the_catalogue() -> None:
    """Texts with a space in them are words, but for lists of classes and paths."""
    for name, text in OTHERS.items():
        code = re.sub(
            r"^\s*//.*$|\s//\s.*$|data-[\w-]+|class: `[^`]*`", "", text, flags=re.MULTILINE
        )
        assert not re.findall(r'"([A-Z][a-z]+(?: [a-z]+)+[.…]?)"', code), name


def test_nothing_is_read_as_markup() -> None:
    for name, text in OTHERS.items():
        assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|\.style\s*=|cssText", text), (
            name
        )
