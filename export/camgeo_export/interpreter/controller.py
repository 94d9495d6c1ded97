"""What the interpreter goes by: a machine profile, prepared for looking words up."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from camgeo.toolpath.machine import Machine
from camgeo_export.interpreter.codes import COMMON, GROUP_OF, normal

ALONE: Final = ("SUPA", "G500")
"""Names that are words themselves, without a number or arguments."""


@dataclass(frozen=True, slots=True)
class Controller:
    """A profile as the interpreter asks for it.

    Attributes
    ----------
    machine : the profile.
    meanings : of every word that the controller accepts and that is read, e.g. {"G1": "line"}; of
        names with more than one letter only those of the profile.
    accepted : every word that it accepts, also those that are not read.
    letters : that may begin a word.
    names : of commands and addresses of more than one letter.
    brackets : whether ( ) hold comments.
    extended : whether it has commands and addresses with an equals sign, as Sinumerik has.
    groups : modal groups of which it has words.
    dwell_letters : of words with a dwell, the one of the profile's own form first.
    length_letter : "H", or "D" where that puts the tool's length into force by itself; else "".
    needs_length : whether a tool's length must be put into force.
    changes_tools : whether it has a word that changes tools.
    alone : sets of words of which a block may have one.
    """

    machine: Machine
    meanings: dict[str, str]
    accepted: frozenset[str]
    letters: str
    names: frozenset[str]
    brackets: bool
    extended: bool
    groups: frozenset[str]
    dwell_letters: str
    length_letter: str
    needs_length: bool
    changes_tools: bool
    alone: tuple[frozenset[str], ...]

    def smoothing_letter(self, word: str) -> str:
        """Letter of the word with the deviation in the smoothing block that begins with `word`."""
        smoothing = self.machine.smoothing
        for block in smoothing.on if smoothing is not None else ():
            found = re.search(r"([A-Z])\{p\}", block)
            if found and block.split()[0] == word:
                return found[1]
        return ""


def controller_of(machine: Machine) -> Controller:
    """The controller of a profile."""
    words = machine.words
    accepted = {normal("G", f"{code:g}") for code in words.g}
    accepted |= {normal("M", f"{code:g}") for code in words.m}
    meanings = {word: COMMON[word] for word in accepted if word in COMMON}
    meanings |= words.own_meanings
    meanings = {word: meaning for word, meaning in meanings.items() if meaning != "not read"}
    lengths = machine.tool_change.length_offset
    length_letter = ""
    if any("H{tool}" in block for block in lengths):
        length_letter = "H"
    elif any(re.match(r"D\d", block) for block in lengths):
        length_letter = "D"
    own_dwells = machine.reading.dwell
    dwells = [re.search(r"([A-Z])\{dwell\}", block) for block in machine.dwell.blocks]
    return Controller(
        machine,
        meanings,
        frozenset(accepted | set(words.names)),
        words.letters,
        frozenset(words.names),
        machine.text.comment_open.strip().startswith("("),
        any(len(name) > 1 for name in words.names),
        frozenset(GROUP_OF[meaning] for meaning in meanings.values()),
        "".join(dict.fromkeys(next((found[1] for found in dwells if found), "P") + own_dwells)),
        length_letter,
        bool(length_letter),
        "tool change" in meanings.values() or machine.dialect == "klartext",
        tuple(frozenset(each.split()) for each in machine.reading.alone),
    )
