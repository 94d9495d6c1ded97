"""The result of `camgeo sweep`, rendered as text, as CSV and as JSON."""

from __future__ import annotations

import csv
import io
from contextlib import closing

import pytest

from camgeo.app.answers import sweep as rendering
from camgeo.app.answers.answer import text
from camgeo.app.answers.sweep import FEW, answer_of, comma_separated
from camgeo.studies.sweep.sweep import sweep
from tests.answers.documents import document
from tests.sweep.families import family

ASK = ("largest-acceleration", "transmission-angle")


def test_of_many_designs_only_the_ends_are_printed() -> None:
    with closing(sweep(family(f"follower.base_radius=45:60:{FEW + 1}"), ASK)) as many:
        answer = answer_of(many)
        words = text(answer).splitlines()
        least = min(each.answers["transmission-angle"] for each in answer.designs)  # type: ignore[type-var]  # numbers
    assert words[0] == f"setzhub: {FEW + 1} designs"
    assert len(words) < 15
    place = words.index(f"transmission-angle [deg]: {FEW + 1} answers")
    assert words[place + 1] == f"  least     {least:.7g}  at follower.base_radius = 45"


def test_words_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rendering, "FEW", 1)
    with closing(sweep(family("follower.base_radius=40,50"), ["verdict"])) as result:
        answer = answer_of(result)
        document(answer)
        assert "\nverdict: broken 1, invalid 1" in text(answer)
        assert answer.spans[0].least is None


def test_designs_with_different_units() -> None:
    with closing(sweep(family("units.length=mm,inch"), ["max:s", "laws"])) as result:
        answer = answer_of(result)
        reported = document(answer)
        rows = list(csv.reader(io.StringIO(comma_separated(answer).decode())))
        assert "58.5 mm" in text(answer)
        assert "58.5 inch" in text(answer)
    assert reported["questions"][0]["unit"] == ""
    assert reported["questions"][0]["least"] is None
    assert [each["units"] for each in reported["designs"]] == [{"max:s": "mm"}, {"max:s": "inch"}]
    assert rows[0] == ["units.length", "max:s", "max:s unit", "laws", "reason"]
    assert [row[2] for row in rows[1:]] == ["mm", "inch"]
