"""Every field of our files changed in turn: verify tells, or the change is harmless.

A harmless change is one that leaves what the file means as it was: the same moves, or something
that no program takes as part of the geometry. The tables below name those of the second kind.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from camgeo.toolpath.spec import Tool
from camgeo.verifying.verification import Check, Reading, Verifier
from camgeo_export.gcode import reader
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.verify.gcode import VERIFIER as GCODE_VERIFIER
from tests.export.stub_product import StubProduct

TOLERANCE = 0.01

PRODUCT = StubProduct(second_tool=Tool(2, 8.0, 2500.0, 250.0, 80.0))


def faults(verifier: Verifier, data: bytes, product: StubProduct = PRODUCT) -> list[Check]:
    """The checks that fail of a file that should be one of ours, those of its origin included."""
    origin = verifier.origin(data)
    if origin.damage:
        return [Check("file", ok=False, note=origin.damage)]
    checks = verifier.checks(product, data, Reading("file", ours=origin.ours), TOLERANCE)
    named = Check(
        "scene", value=origin.scene, ok=product.scene_hash.startswith(origin.scene or "-")
    )
    stated = Check("tolerance", value=origin.tolerance, ok=origin.tolerance in (None, TOLERANCE))
    return [check for check in (named, stated, *checks) if check.ok is False]


# Programs -----------------------------------------------------------------------------------------

PROGRAM = GCODE.write(PRODUCT, TOLERANCE).data.decode().splitlines()

WORD = re.compile(r"([A-Z])(-?[\d.]+)")

HARMLESS_WORDS = {
    ("(camgeo 0.0.test, for LinuxCNC)", "0.0.test"),  # of another version: its words may differ
    ("(camgeo 0.0.test, for LinuxCNC)", "camgeo"),  # then it is a foreign program
    ("(camgeo 0.0.test, for LinuxCNC)", ""),
    ("G64 P0.0030 Q0", "P0"),  # a smaller path blending, down to none
    ("G0 Z5.0000", ""),  # where the next one leads there again
    ("G0 Z5.0000", "Z5.0000"),
    ("M5", "M6"),  # a change of tools at the end stops the spindle, too
}
"""Line and the word in it that may be changed, or the line that may be left out."""


def changed_lines() -> list[int]:
    """The lines that are changed: of blocks with the same words after the same ones, the first."""
    words = [
        tuple(re.findall(r"G\d+|[A-Z]", line)) if line[0] != "(" else (line,) for line in PROGRAM
    ]
    pairs = list(zip([(), *words], words, strict=False))
    return [k for k, pair in enumerate(pairs) if pair not in pairs[:k]]


def changed_words(line: str) -> Iterator[tuple[str, str]]:
    """Each word of a line, and the line with that word changed or left out; the line left out."""
    yield "", ""
    if line.startswith("("):
        for found in re.finditer(r"[\w.]+", line):
            word = found.group()
            other = word[:-1] + ("1" if word[-1] != "1" else "2")
            yield word, line[: found.start()] + other + line[found.end() :]
        return
    yield "A", f"{line} A0"
    for found in WORD.finditer(line):
        letter, value = found.groups()
        number = float(value)
        others = [f"{0.5 - number:.4f}"]
        if letter not in "XYZIJ":
            others = [f"{number + 1.0:g}", "99" if letter in "GM" else "0"]
        for new in (*(letter + other for other in others if float(other) != number), ""):
            after = f"{line[: found.start()]}{new}{line[found.end() :]}"
            yield new or found.group(), " ".join(after.split())


def test_a_program_that_is_changed() -> None:
    good = reader.read("\n".join(PROGRAM))
    assert not faults(GCODE_VERIFIER, "\n".join(PROGRAM).encode())
    unseen = []
    for k in changed_lines():
        for word, line in changed_words(PROGRAM[k]):
            text = "\n".join([*PROGRAM[:k], line, *PROGRAM[k + 1 :]])
            if faults(GCODE_VERIFIER, text.encode()):
                continue
            if repr(reader.read(text)) != repr(good):  # with NaN, which is equal to nothing
                unseen.append((PROGRAM[k], word))
    assert set(unseen) == HARMLESS_WORDS


@pytest.mark.parametrize(
    ("old", "new", "check", "said"),
    [
        ("F300", "F30000", "feed", "line 21"),
        ("F100", "F1000", "plunge feed", "line 20"),
        ("S3000", "S30000", "spindle speed", "line 20"),
        ("T1 M6", "T9 M6", "tool", "line 20"),
        ("G43 H1", "G43 H9", "tool length", "line 20"),
        ("diameter 6 mm", "diameter 12 mm", "cutters", "tool 1 of 12 mm; tool 2 of 8 mm, not"),
        ("(part eccentric)", "(part other)", "comments", "'part other' where 'part eccentric'"),
        ("depths -4", "depths -5", "comments", "depths -5.0000"),
        ("G0 Z5.0000", "G0 Z50.0000", "traverses", "line 16: a traverse to Z 50 mm, not 5 mm"),
        ("X4.2000 Y2.8000 I-2.8000 J0.0000\nG0 Z5.0000\nT2", "X4.2000 Y2.8000 I-2.8000 J0\nT2",
         "safety", "M6 at Z -8 mm, below the safe height"),
        ("G1 Z-4.0000 F100", "G1 Z-4.0000 F100\nG1 Z-4.5\nG1 Z-4.0000", "moves",
         "line 21: a cut at Z -4.5 mm, which is not one of its depths"),
        ("S2500 M3", "", "safety", "with the spindle off"),
    ],
)  # fmt: skip
def test_what_is_told_of_a_program(old: str, new: str, check: str, said: str) -> None:
    """The check with the place and the reason."""
    text = "\n".join(PROGRAM)
    assert old in text
    found = faults(GCODE_VERIFIER, text.replace(old, new, 1).encode())
    assert said in {each.name: each.note for each in found}[check]


def test_programs_of_other_versions_are_read() -> None:
    """Comments of before gave the diameter and the tolerance of an inch program in mm alone."""
    product = StubProduct(unit="inch")
    text = GCODE.write(product, TOLERANCE).data.decode()
    assert "(tolerance 0.000393701 inch, 0.01 mm)" in text
    assert "(tool 1: end mill, diameter 0.2362 inch, 6 mm)" in text
    assert "(fit within 0.0002" in text
    assert not faults(GCODE_VERIFIER, text.encode(), product)
    for old, new in (("0.000393701 inch, ", ""), ("0.2362 inch, ", ""), ("0.0.test", "0.0.1")):
        text = text.replace(old, new)
    assert not faults(GCODE_VERIFIER, text.encode(), product)
