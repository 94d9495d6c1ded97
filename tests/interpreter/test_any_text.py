"""Whatever a text holds, running it gives a result: no exception, and findings by line."""

from __future__ import annotations

import re
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.milling.machine import load, names
from camgeo_export.interpreter.moves import RULES, Run
from camgeo_export.interpreter.run import run
from tests.interpreter.programs import GOOD
from tests.long_form import examples

WORDS = (
    *("G0", "G1", "G2", "G3", "G4", "G10", "G17", "G18", "G20", "G21", "G28", "G40", "G41", "G42"),
    *("G41.1", "G43", "G43.1", "G49", "G53", "G54", "G61", "G64", "G80", "G81", "G90", "G90.1"),
    *("G91", "G91.1", "G93", "G94", "G95", "G99.9", "M0", "M2", "M3", "M5", "M6", "M8", "M30"),
    *("X1", "Y-2.5", "Z3.", "X0", "Y0", "Z0", "I1", "J-1", "K1", "R5", "R-1", "R0", "P2", "Q0"),
    *("F100", "F0", "S1000", "T1", "T99999", "H1", "D1", "D.5", "N10", "O1", "E1", "L2", "A9"),
    *("(", ")", "(a)", ";", "%", "/", "#1", "[1+1]", "X=AC(5)", "I=IC(2)", "CR=7", "TURN=2"),
    *("CYCLE832(0.01,1,1)", "CYCLE832()", "SUPA", "MSG(1)", "T=\"A\"", "L", "LP", "CC", "C", "CP"),
    *("CR", "CT", "CTP", "X+1", "IX-3", "PR+5", "PA+30", "IPA-400", "DR+", "DR-", "R+5", "RL"),
    *("RR", "R0", "FMAX", "M91", "BEGIN PGM A MM", "END PGM A MM", "TOOL CALL 1 Z S9", "STOP"),
    *("CYCL DEF 32.1 T0.1", "CYCL DEF 9.1 DWELL 1", "CYCL DEF 247 Q339=+1", "RND R2", "1e9", "--1"),
    *("X1.7976931348623157e308", "Y999999999", "\x00", "\xe4", "X" + "9" * 70, ""),
)  # fmt: skip


def check(found: Run, text: str) -> None:
    lines = len(re.split(r"\r\n|\r|\n", text))
    for each in found.findings:
        assert 0 <= each.line <= lines
        assert each.concerns == RULES[each.rule]
        assert str(each).isprintable() or each.rule in ("unreadable", "unsupported")
    found.loops()


@pytest.mark.parametrize("machine", names())
@given(st.lists(st.lists(st.sampled_from(WORDS), max_size=6), max_size=25))
def test_words_in_any_order(machine: str, blocks: list[list[str]]) -> None:
    text = "\n".join(" ".join(block) for block in blocks)
    check(run(text, load(machine)), text)


@pytest.mark.parametrize("machine", names())
@pytest.mark.parametrize("seed", range(examples(4, long=400)))
def test_good_programs_that_are_damaged(machine: str, seed: int) -> None:
    rng = Random(seed)
    text = GOOD[machine]
    for _ in range(rng.choice((1, 3, 10))):
        at = rng.randrange(len(text) + 1)
        to = min(at + rng.choice((0, 1, 5, 40)), len(text))
        text = text[:at] + rng.choice(("", " ", rng.choice(WORDS), text[at:to] * 2)) + text[to:]
    check(run(text, load(machine)), text)
