"""Text in the words of ISO 6983 taken apart: comments, words, commands.

Covers the dialects of our profiles: comments in brackets or behind a semicolon, `%` and `O`
around programs, and Sinumerik's commands `CYCLE832(...)`, addresses with an equals sign and
coordinates with `AC(...)` or `IC(...)`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

from camgeo.reading import COORDINATE, DIGITS, number_of
from camgeo.wording import shortened
from camgeo_export.interpreter.block import Number
from camgeo_export.interpreter.rules import Findings

NUMBER: Final = r"[-+]?(?:\d+\.?\d*|\.\d+)"

PLAIN: Final = re.compile(rf"(?:\s*+[A-Z]\s*+{NUMBER})*+\s*+", re.ASCII)
"""A block of words only."""

WORD: Final = re.compile(rf"([A-Z])\s*+({NUMBER})", re.ASCII)

TOKEN: Final = re.compile(
    rf"""\s*+(?:
      (?P<command>[A-Z_][A-Z_0-9]*+)\s*+\((?P<arguments>(?:"[^"]*+"|[^()"]++)*+)\)
    | (?P<address>[A-Z]+\d*+)\s*+=\s*+(?:
          (?P<value>{NUMBER}) | (?P<way>AC|IC)\s*+\(\s*+(?P<inner>{NUMBER})\s*+\)
        | "(?P<name>[^"]*+)" )
    | (?P<letter>[A-Z])\s*+(?P<number>{NUMBER})(?![\d.=])
    | (?P<keyword>[A-Z_]{{2,}}+[A-Z_0-9]*+)
    )""",
    re.ASCII | re.VERBOSE,
)

BRACKETS: Final = re.compile(r"\(([^()]*+)\)", re.ASCII)

LONGEST: Final = 60
"""Characters of a block that a finding shows."""

FLOW: Final = re.compile(
    r"[#\[\]]|\bR\d+\s*=|\b(?:IF|WHILE|GOTO[BFCS]?|FOR|LOOP|DEF|PROC|SUB|ENDSUB|CALL|DO|REPEAT)\b"
)
"""Parameters, expressions and control of flow."""


@dataclass(slots=True)
class Words:
    """One line taken apart.

    Attributes
    ----------
    line : in the file, counted from 1.
    words : letters or addresses with their numbers, in their order.
    ways : of Sinumerik's coordinates: "AC" or "IC", by address.
    commands : names with what is in their brackets; keywords have None.
    names : texts in quotes by their addresses.
    """

    line: int
    words: list[tuple[str, Number]] = field(default_factory=list)
    ways: dict[str, str] = field(default_factory=dict)
    commands: list[tuple[str, str | None]] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)


def without_comments(
    line: int, text: str, brackets: bool, findings: Findings, *, may_end: bool = False
) -> tuple[str, list[str]]:
    """The block in a line, and its comments; `brackets` says whether ( ) hold some, which with
    `may_end` may end with the line.
    """
    if not brackets:
        block, mark, note = text.partition(";")
        return block, [note.strip()] if mark else []
    if "(" not in text and ")" not in text:
        block, mark, note = text.partition(";")
        return block, [note.strip()] if mark else []
    notes: list[str] = []
    while found := BRACKETS.search(text):
        cut = text.find(";", 0, found.start())
        if cut >= 0:
            break
        notes.append(found[1].strip())
        text = f"{text[: found.start()]} {text[found.end() :]}"
        if notes and text.count("(") and found.start() > text.find("("):
            findings.add(line, "comment", "a comment in brackets holds another")
            return text.partition("(")[0], notes
    block, mark, note = text.partition(";")
    if mark:
        notes.append(note.strip())
    for bracket in "()":
        if bracket in block and not (bracket == "(" and may_end):
            what = "a comment does not end in its line" if bracket == "(" else "a bracket too many"
            findings.add(line, "comment", what, bracket)
        if bracket in block:
            block = block.partition(bracket)[0] if bracket == "(" else block.replace(")", " ")
    return block, notes


def words_of(line: int, block: str, extended: bool, findings: Findings) -> Words | None:
    """The words of a block without comments, in capitals; None if it cannot be read.

    `extended` allows Sinumerik's commands and addresses.
    """
    found = Words(line)
    if PLAIN.fullmatch(block):
        for letter, text in WORD.findall(block):
            if not _put(found, letter, text, findings):
                return None
        return found
    if not extended and PLAIN.fullmatch(joined := "".join(block.split())):
        return words_of(line, joined, extended, findings)
    if FLOW.search(block):
        what = "parameters, expressions and control of flow are outside what is read"
        findings.add(line, "unsupported", what, shown(block))
        return None
    if not extended:
        rest = WORD.sub(" ", block).split()
        findings.add(line, "unreadable", "cannot be read", shown(" ".join(rest) or block))
        return None
    return found if _extended(found, block, findings) else None


def _extended(found: Words, block: str, findings: Findings) -> bool:
    at, end = 0, len(block.rstrip())
    while at < end:
        token = TOKEN.match(block, at)
        if token is None:
            findings.add(found.line, "unreadable", "cannot be read", shown(block[at:].strip()))
            return False
        at = token.end()
        if token["command"]:
            found.commands.append((token["command"], token["arguments"].strip()))
        elif token["keyword"]:
            found.commands.append((token["keyword"], None))
        elif token["name"] is not None:
            found.names[token["address"]] = token["name"]
        else:
            address = token["letter"] or token["address"]
            if token["way"]:
                found.ways[address] = token["way"]
            text = token["number"] or token["value"] or token["inner"]
            if not _put(found, address, text, findings):
                return False
    return True


def _put(found: Words, letter: str, text: str, findings: Findings) -> bool:
    value = number_of(text)
    if value is None:
        what = f"the word {(letter + text)[:40]} has more than {DIGITS} digits or is beyond"
        findings.add(found.line, "number", f"{what} {COORDINATE:g}")
        return False
    found.words.append((letter, Number(value, text)))
    return True


def shown(text: str) -> str:
    """What a finding shows of a text."""
    return shortened(text, LONGEST)
