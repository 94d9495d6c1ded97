"""docs/machines.md is made from the schema and the profiles, and has all of them."""

from __future__ import annotations

import re
from pathlib import Path

from camgeo.milling.machine import load, names, schema
from tests.pages import page_maker

ROOT = Path(__file__).resolve().parents[1]

PAGE = (ROOT / "docs" / "machines.md").read_text(encoding="utf-8")


def test_the_page_is_made_by_its_script() -> None:
    assert page_maker("machines_page").page() == PAGE, "run python docs/machines_page.py"


def test_every_key_and_every_profile_stand_on_it_and_readme_names_it() -> None:
    for key, node in schema()["properties"].items():
        assert f"[{key}]" in PAGE or f"| `{key}` |" in PAGE
        for inner in node.get("properties", {}):
            section = PAGE.partition(f"`[{key}]`")[2]
            assert f"| `{inner}` |" in section
    for name in names():
        assert f"\n### {name}\n" in PAGE
        assert all(each.text in PAGE for each in load(name).evidence)
    assert "(docs/machines.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_what_is_not_confirmed_is_said() -> None:
    for name in names():
        missing = [each for each in load(name).evidence if each.kind == "none"]
        section = PAGE.partition(f"### {name}, evidence")[2].partition("\n### ")[0]
        assert len(re.findall("not confirmed: ", section)) == len(missing)
