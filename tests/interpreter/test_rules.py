"""Rules of the interpreter: named, described, and each found by some test."""

from __future__ import annotations

import re
from pathlib import Path

from camgeo.milling.machine import MEANINGS
from camgeo_export.interpreter.controller import COMMON, GROUP_OF
from camgeo_export.interpreter.moves import RULES
from tests.interpreter.test_foolish import LINUXCNC, OTHERS

ROOT = Path(__file__).parents[2]

PAGE = ROOT / "docs" / "lint.md"


def test_the_page_describes_every_rule_with_its_concern() -> None:
    said: dict[str, str] = {}
    for line in PAGE.read_text("utf-8").splitlines():
        if found := re.match(r"\| ((?:`[a-z-]+`(?:, )?)+) \| (\w+) \|", line):
            said |= dict.fromkeys(re.findall(r"`([a-z-]+)`", found[1]), found[2])
    assert said == dict(RULES)


def test_every_rule_is_used() -> None:
    folder = ROOT / "export" / "camgeo_export" / "interpreter"
    code = "".join(path.read_text("utf-8") for path in folder.glob("*.py") if path.stem != "rules")
    assert [rule for rule in RULES if f'"{rule}"' not in code] == []


def test_most_rules_are_broken_by_a_foolish_program() -> None:
    broken = {change.rule for change in LINUXCNC + OTHERS}
    assert RULES.keys() - broken <= {
        *("arc-sweep", "helix", "no-motion", "nothing", "number", "plane", "unknown-position"),
    }


def test_meanings_are_in_groups() -> None:
    assert set(COMMON.values()) <= GROUP_OF.keys()
    assert (
        set(MEANINGS) - {"not read"} == GROUP_OF.keys()
    )  # profiles name what the interpreter knows
