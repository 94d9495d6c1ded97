"""Good files with a few bytes or words changed at random, the same for the same seed."""

from __future__ import annotations

import random
import re
from typing import Final

WORD: Final = re.compile(rb"[\w.+-]+")

WORDS: Final = (
    b"nan", b"inf", b"-1", b"0", b"1e308", b"-1e-320", b"9" * 310, b"", b"\0", b"\xff\xfe",
    b"\xef\xbc\x91", b"1e9", b"0x10", b"[", b"]", b'"', b"{", b"<", b"&a;", b"\r", b"\n\n", b",",
    b"= ", b"2147483648", b"1_0", b"true", b"null", b"(", b";",
)  # fmt: skip


def mutated(data: bytes, seed: int) -> bytes:
    """`data` with one to eight changes."""
    chance = random.Random(seed)
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 4, 8))):
        place = chance.randrange(len(found) + 1)
        match chance.randrange(7):
            case 0:
                found[place : place + 1] = bytes([chance.randrange(256)])
            case 1:
                del found[place : place + chance.choice((1, 2, 40, 4000))]
            case 2:
                other = chance.randrange(len(found) + 1)
                found[place:place] = found[other : other + chance.choice((1, 30, 2000))]
            case 3 if place < len(found):
                found[place] ^= 1 << chance.randrange(8)
            case 4:
                found[place : place + 4] = chance.choice((bytes(4), b"\xff" * 4, b"\0\0\0\x80"))
            case _:
                word = WORD.search(found, place)
                start, end = word.span() if word else (place, place)
                found[start:end] = chance.choice(WORDS)
    return bytes(found)


def repacked(parts: dict[str, bytes], seed: int) -> bytes:
    """A package with one of its parts mutated, its sums right."""
    from camgeo_export.threemf.parts import packed

    name = random.Random(seed).choice(sorted(parts))
    return packed({**parts, name: mutated(parts[name], seed)})
