"""The result of `camgeo optimise`, rendered as text, as CSV, as JSON and as a picture."""

from __future__ import annotations

import csv
import io

from camgeo.app.answers.answer import figure, text
from camgeo.app.answers.optimise import Optimum, comma_separated
from camgeo.studies.optimise.optimise import optimise, task_of
from tests.answers.documents import document
from tests.optimise.cams import PLAIN

VARY = ("follower.base_radius=-1,48,51,53", "motion.2.law,motion.4.law=polynomial-345")


def test_a_front_and_what_lies_beyond_limits() -> None:
    task = task_of(PLAIN, VARY, least=["diameter"], largest=["transmission-angle"])
    answer = Optimum(optimise(task))
    reported, words = document(answer), text(answer)
    rows = list(csv.reader(io.StringIO(comma_separated(answer).decode())))
    assert (reported["evaluations"], reported["kept"], answer.exit_code) == (4, 2, 0)
    assert reported["scene"]["sha256"] == PLAIN.identity
    assert reported["objectives"] == [
        {"asked": "diameter", "sense": "least", "unit": "mm"},
        {"asked": "transmission-angle", "sense": "largest", "unit": "deg"},
    ]
    assert reported["bounds"][0]["values"] == [[-1], [48], [51], [53]]
    assert [each["values"]["follower.base_radius"] for each in reported["front"]] == [51, 53]
    assert reported["written"] == reported["best"]
    assert reported["start"] is None
    assert "2 designs that no other beats:" in words
    assert "follower.base_radius one of -1, 48, 51, 53" in words
    assert rows[0][:2] == ["number", "follower.base_radius"]
    assert rows[1][-1].startswith("follower.base_radius = -1: must be")
    (panel,) = figure(answer).panels
    assert panel.legend is not None
    assert [entry.label for entry in panel.legend.entries] == [
        "beyond a limit", "within all limits", "Pareto front", "chosen"]  # fmt: skip


def test_nothing_within_limits() -> None:
    task = task_of(PLAIN, ["follower.base_radius=-1,48"], least=["diameter"], keep=["max:mu<=10"])
    answer = Optimum(optimise(task))
    reported, words = document(answer), text(answer)
    assert reported["written"] is None
    assert reported["best"]["values"] == {"follower.base_radius": 48}
    assert len(reported["best"]["violated"]) == 2
    assert answer.exit_code == 1
    assert "the nearest violates:\n  max:mu <= 10: it is" in words
    assert figure(answer).panels
