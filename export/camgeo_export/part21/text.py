"""The text of an exchange file by ISO 10303-21: its header and its instances, with all values."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, NoReturn

from camgeo.errors import FileError
from camgeo.reading import (
    COORDINATE,
    INSTANCES,
    NESTED,
    PARAMETERS,
    STEP,
    beyond,
    check_size,
    number_of,
)

FIRST, LAST = "ISO-10303-21", "END-ISO-10303-21"

TOKEN: Final = re.compile(
    r"(?P<space>(?:[ \t\r\n\f]++|/\*(?:[^*]++|\*(?!/))*+\*/)++)"
    r"|(?P<ref>\#[0-9]{1,9}+)"
    r"|(?P<real>[+-]?[0-9]++\.[0-9]*+(?:[Ee][+-]?[0-9]++)?)"
    r"|(?P<whole>[+-]?[0-9]++)"
    r"|(?P<string>'(?:[^']++|'')*+')"
    r"|(?P<enumeration>\.[A-Z_][A-Z0-9_]*+\.)"
    r"|(?P<word>!?[A-Z_][A-Z0-9_-]*+)"
    r'|(?P<binary>"[0-9A-F]*+")'
    r"|(?P<mark>[()=;,$*])"
    r"|(?P<wrong>.)",
    re.DOTALL,
)
"""Blanks and comments between tokens, or one token, or a character that begins none: wherever it
begins there is a match, and no text is searched twice.
"""

CODED: Final = re.compile(
    r"\\X2\\((?:[0-9A-F]{4})++)\\X0\\|\\X4\\((?:[0-9A-F]{8})++)\\X0\\"
    r"|\\X\\([0-9A-F]{2})|\\S\\([ -~])|\\P[A-I]\\|\\\\|(\\)"
)
"""A directive in a string, a backslash that is doubled, or one that is wrong."""

RECORDS: Final = 20
"""Of a header, which has three, and at most four more."""

BEYOND: Final = 0x110000
"""First number that is no character."""


class Ref(int):
    """A reference to an instance."""


class Word(str):
    """An enumeration, without its points; `*` for a value that is derived."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Record:
    """A type and its parameters: texts, numbers, `Ref`, `Word`, None, records or tuples of these.

    A parameter that names its type is a record.
    """

    kind: str
    values: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Exchange:
    """The contents of a file.

    Attributes
    ----------
    header : the records of the header section.
    instances : by their numbers; several records for one of several types.
    """

    header: tuple[Record, ...]
    instances: dict[int, tuple[Record, ...]]


def exchange_of(data: bytes, *, whole: bool = True) -> Exchange:
    """The contents of a file, or with `whole` false its header alone.

    Raises FileError with the line where it breaks the syntax, or if it is beyond the limits of
    `camgeo.reading`.
    """
    check_size(len(data), STEP, "the file")
    found = data.count(b",") + data.count(b"(")
    if found > PARAMETERS:
        raise beyond("the file", f"{found:,} commas and brackets", PARAMETERS, STEP)
    if not data.lstrip()[: len(FIRST)] == FIRST.encode():
        raise FileError("not a STEP file: it does not begin with ISO-10303-21")
    if not data.rstrip().endswith(f"{LAST};".encode()):
        raise FileError(f"not a complete STEP file: no {LAST} at its end")
    return _Parser(data.decode("utf-8", "replace")).exchange(whole)


class _Parser:
    """Reads a text once, from its start."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.end = 0
        self.tokens = self._tokens()
        self.kind = self.token = ""
        self.next()

    def _tokens(self) -> Iterator[tuple[str, str]]:
        for found in TOKEN.finditer(self.text):
            kind = found.lastgroup
            if kind == "wrong":
                self.fail(f"{self.text[self.end : self.end + 20]!r} is nothing that STEP knows")
            self.end = found.end()
            if kind != "space":
                yield str(kind), found.group()

    def fail(self, what: str) -> NoReturn:
        line = 1 + self.text.count("\n", 0, self.end)
        raise FileError(f"line {line}: {what}")

    def next(self) -> None:
        self.kind, self.token = next(self.tokens, ("end", "the end of the file"))

    def take(self, token: str) -> None:
        if self.token != token:
            self.fail(f"{token!r} expected, not {self.token[:40]!r}")
        self.next()

    def exchange(self, whole: bool) -> Exchange:
        for token in (FIRST, ";", "HEADER", ";"):
            self.take(token)
        header = []
        while self.token != "ENDSEC":
            header.append(self.record())
            self.take(";")
            if len(header) > RECORDS:
                self.fail(f"the header has more than {RECORDS} records")
        instances: dict[int, tuple[Record, ...]] = {}
        if whole:
            for token in ("ENDSEC", ";", "DATA", ";"):
                self.take(token)
            while self.kind == "ref":
                self.instance(instances)
            for token in ("ENDSEC", ";", LAST, ";"):
                self.take(token)
            if self.kind != "end":
                self.fail("there is more after its end")
        return Exchange(tuple(header), instances)

    def instance(self, instances: dict[int, tuple[Record, ...]]) -> None:
        number = int(self.token[1:])
        if number in instances:
            self.fail(f"#{number} is there twice")
        if len(instances) == INSTANCES:
            raise beyond("the file", "more entities", INSTANCES, STEP)
        self.next()
        self.take("=")
        records = []
        if self.token == "(":
            self.next()
            while self.token != ")":
                records.append(self.record())
            self.next()
        else:
            records.append(self.record())
        self.take(";")
        instances[number] = tuple(records)

    def record(self) -> Record:
        if self.kind != "word":
            self.fail(f"a type expected, not {self.token[:40]!r}")
        kind = self.token
        self.next()
        self.take("(")
        return Record(kind, self.values(NESTED))

    def values(self, depth: int) -> tuple[Any, ...]:
        """The parameters behind an opening bracket."""
        if depth == 0:
            self.fail(f"lists are nested more than {NESTED} deep")
        found: list[Any] = []
        if self.token == ")":
            self.next()
            return ()
        while True:
            found.append(self.value(depth))
            if self.token == ")":
                self.next()
                return tuple(found)
            self.take(",")

    def value(self, depth: int) -> Any:
        kind, token = self.kind, self.token
        self.next()
        match kind:
            case "ref":
                return Ref(token[1:])
            case "real" | "whole":
                return self.number(kind, token)
            case "string":
                return self.string(token)
            case "enumeration":
                return Word(token[1:-1])
            case "word":
                self.take("(")
                return Record(token, self.values(depth - 1))
            case "binary":
                return Word(token)
        if token == "(":
            return self.values(depth - 1)
        if token not in ("$", "*"):
            self.fail(f"a value expected, not {token[:40]!r}")
        return None if token == "$" else Word(token)

    def number(self, kind: str, token: str) -> float | int:
        found = number_of(token)
        if found is None:
            self.fail(f"{token[:40]} is not a number of at most {COORDINATE:g}")
        return int(token) if kind == "whole" else found

    def string(self, token: str) -> str:
        text = token[1:-1].replace("''", "'")
        return CODED.sub(self.decoded, text) if "\\" in text else text

    def decoded(self, found: re.Match[str]) -> str:
        """The characters of a directive."""
        two, four, one, shifted, wrong = found.groups()
        if wrong:
            self.fail("a string has a backslash that begins no directive")
        if shifted:
            return chr(ord(shifted) + 128)
        if one:
            return chr(int(one, 16))
        digits, size = (two, 4) if two else (four, 8)
        if digits is None:
            return "\\" if found.group() == "\\\\" else ""
        codes = [int(digits[k : k + size], 16) for k in range(0, len(digits), size)]
        if any(code >= BEYOND or 0xD800 <= code < 0xE000 for code in codes):
            self.fail(f"a string has {found.group()[:40]}, which is no character")
        return "".join(map(chr, codes))
