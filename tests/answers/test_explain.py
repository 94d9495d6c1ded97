"""The result of `camgeo explain`, rendered as text and as JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.check import check
from tests.answers.documents import FIXTURES, explained

SPRUNG = FIXTURES / "effects" / "lift_off_elastic.toml"
PAIR = FIXTURES / "scenes" / "conjugate_lever.toml"
MILLED = FIXTURES / "scenes" / "ring.toml"
REFUSED = sorted((FIXTURES / "refused").glob("*.toml"))


@pytest.mark.parametrize("scene", [SPRUNG, PAIR, MILLED, *REFUSED], ids=lambda path: path.stem)
def test_each_finding_of_a_check_stands_at_what_made_it(scene: Path) -> None:
    design, found = explained(scene)
    told = [each for own in found.findings.values() for each in own]
    assert sorted(told, key=repr) == sorted(check(design).everything, key=repr)
    runs = [each.name for each in found.computed if each.name in found.findings]
    assert sorted(runs) == sorted(found.findings)


def test_text_names_findings_with_severities_other_than_ok() -> None:
    found = explained(SPRUNG)[1]
    (name, own), *_ = ((name, own) for name, own in found.findings.items() if len(own) > 1)
    changed = replace(own[0], name="the-moon", severity="broken")
    words = text(replace(found, findings={**found.findings, name: (changed, changed, *own[2:])}))
    (line,) = [line for line in words.splitlines() if f"  {name}: " in line]
    assert "2 the-moon (broken)" in line
