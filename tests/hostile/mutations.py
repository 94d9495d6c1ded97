"""Good files with a few bytes, words or lines changed at random."""

from __future__ import annotations

import math
import re
from random import Random
from typing import Final

from camgeo_export.verify.threemf import packed

WORD: Final = re.compile(rb"[\w.+-]+")

EDGES: Final = (
    *(0.0, -0.0, 5e-324, 1e-300, 1e-12, 1e-9, 1e-6, 1.0, 90.0, 180.0, 360.0, 1e9, 1e15, 1e300),
    *(-1.0, -5e-324, -1e-9, -360.0, -1e300, math.nextafter(1.0, 0.0), math.nextafter(360.0, 0.0)),
    *(1.7976931348623157e308, math.inf, -math.inf, math.nan, 0, 1, -1, 2**31, 2**63 - 1),
)
"""Numbers at which programs fail."""

WORDS: Final = (
    *(repr(each).encode() for each in EDGES),
    *(
        b"9" * 310,
        b"0" * 5000,
        b"1e999",
        b"1.2.3",
        b"0x10",
        b"1_0",
        b"\xef\xbc\x91",
        b"",
        b"-",
        b"\0",
    ),
    *(
        b"\xff",
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"\r",
        b"\n",
        b"\n\n",
        b",",
        b";",
        b"= ",
        b'"',
        b"&a;",
    ),
    *(b"[", b"[" * 2000, b"]", b"{", b"(", b"<", b"true", b"null"),
)


def mutated(data: bytes, chance: Random) -> bytes:
    """`data` with one to eight changes, mostly of words."""
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 4, 8))):
        place = chance.randrange(len(found) + 1)
        other = chance.randrange(len(found) + 1)
        match chance.randrange(12):
            case 0:
                found[place : place + 1] = chance.randbytes(1)
            case 1:
                del found[place : place + chance.choice((1, 2, 40, 4000, len(found)))]
            case 2:
                found[place:place] = found[other : other + chance.choice((1, 30, 2000))]
            case 3 if place < len(found):
                found[place] ^= 1 << chance.randrange(8)
            case 4:
                found[place : place + 4] = chance.choice((bytes(4), b"\xff" * 4, b"\0\0\0\x80"))
            case 5:
                found[place:place] = chance.choice(WORDS)
            case 6:
                lines = found.split(b"\n")
                lines.insert(chance.randrange(len(lines)), lines.pop(chance.randrange(len(lines))))
                found = bytearray(b"\n").join(lines)
            case _:
                word = WORD.search(found, place)
                start, end = word.span() if word else (place, place)
                found[start:end] = chance.choice(WORDS)
    return bytes(found)


def repacked(parts: dict[str, bytes], chance: Random) -> bytes:
    """A package with one of its parts mutated, its sums right."""
    name = chance.choice(sorted(parts))
    return packed({**parts, name: mutated(parts[name], chance)})
