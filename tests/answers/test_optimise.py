"""The result of `camgeo optimise`, rendered as text, as CSV, as JSON and as a picture."""

from __future__ import annotations

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
    assert (reported["evaluations"], reported["kept"], answer.exit_code) == (4, 2, 0)
    assert [each["values"]["follower.base_radius"] for each in reported["front"]] == [51, 53]
    assert reported["written"] == reported["best"]
    assert "2 non-dominated designs:" in words
    assert "follower.base_radius one of -1, 48, 51, 53" in words
    assert b"follower.base_radius = -1: must be" in comma_separated(answer)
    (panel,) = figure(answer).panels
    assert panel.legend is not None
    assert [entry.label for entry in panel.legend.entries] == [
        "beyond a limit", "within all limits", "Pareto front", "chosen"]  # fmt: skip
