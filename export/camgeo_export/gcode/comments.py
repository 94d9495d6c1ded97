"""Comments and numbers of a program, written and read back."""

from __future__ import annotations

import math
import re
import textwrap
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from camgeo.design.product import SECOND as NAME
from camgeo.design.product import Product, title_of
from camgeo.design.verify import length_of
from camgeo.errors import ToleranceError
from camgeo.milling.cut import Cut
from camgeo.milling.machine import ROUNDING_SHARE, ROUNDING_UNITS, Machine, TextForm
from camgeo.milling.milling import HOW, Stock
from camgeo.milling.zero import Zero, described
from camgeo.units import MM_PER, LengthUnit

NUMBER = r"([-+.\de]+)"

TOLERANCE = re.compile(rf"\btolerance (?:{NUMBER} inch, )?{NUMBER} mm", re.IGNORECASE)

ONE_OF = re.compile(r"program (\d{1,4}) of \d{1,4}, run in this order", re.ASCII | re.IGNORECASE)

OFFSET = re.compile(
    r"\bcompensation (?:wear|control): .{1,200}?"
    rf"at most (?:{NUMBER} inch, )?{NUMBER} mm either way",
    re.IGNORECASE,
)

SCENE = re.compile(r"\bscene ((?:[0-9a-f]+ ?)+)", re.IGNORECASE)

SECOND = "second side:"
"""A comment that begins with it says that a program mills the second side."""

HASH_DIGITS = 64

NUMBER_ROOM = 8
"""Characters of a line left for the number of its block."""


def about_program(
    product: Product, machine: Machine, shares: Budget, cuts: Sequence[Cut], scene: str
) -> list[str]:
    """Comments on the whole program, in its unit, exact lengths also in mm; `scene` is the hash of
    the scene to be named.
    """
    unit, zero, milling = product.unit, product.milled.zero, product.milled.spec
    stock = Stock() if milling is None else milling.stock
    tools = {cut.tool.number: cut.tool for cut in cuts}

    def length(mm: float) -> str:
        return f"{mm / MM_PER[unit]:.4g} {unit}"

    blank = described(stock, product.milled.part, zero, unit)
    tolerance = f"{shares.tolerance!r} mm"
    if unit != "mm":
        tolerance = f"{shares.tolerance / MM_PER[unit]:.6g} {unit}, {tolerance}"
    parts = (
        f"part {product.name}",
        side_sentence(product),
        f"camgeo {product.version}, for {machine.name}",
        f"scene {scene}" if scene else "",
        f"unit {unit}, Z 0 on the upper face, origin on the cam axis"
        if zero.is_of_the_part
        else f"unit {unit}, {zero.sentence}",
        *_from(zero, unit),
        f"{'work' if zero.turned else 'blank'}: {blank}",
        f"tolerance {tolerance}",
        f"fit within {length(shares.fit)}, printed within {length(shares.rounding)}",
        f"chords within {length(shares.chord)}, path blending {length(shares.blending)}",
        f"arcs run within {length(shares.interpolation)}" if shares.interpolation > 0.0 else "",
        *(
            f"tool {each}: {tool.kind.replace('-', ' ')}, diameter {spelled(tool.diameter, unit)}"
            + (f", {tool.name}" if tool.name else "")
            for each, tool in tools.items()
        ),
        *product.milled.told,
        ""
        if title_of(product) == product.name
        else f"title {title_of(product)}",  # anyone's words: last
    )
    return [part for part in parts if part]


def side_sentence(product: Product) -> str:
    """Which side of the part a program mills, and how the work lies; empty if there is but one."""
    milled = product.milled
    if milled.first is not None:
        return f"{SECOND} the work is {HOW[milled.zero.turned]}"
    return "" if milled.second is None else f"first side: {product.name}-{NAME} follows it"


def _from(zero: Zero, unit: LengthUnit) -> Iterator[str]:
    """Where the part is, seen from another zero than its own."""
    if not zero.is_of_the_part:
        axis, top = zero.of(0j), 0.0 - zero.z
        places = [number(mm / MM_PER[unit]) for mm in (axis.real, axis.imag, top)]
        face = "lower face of the finished part" if zero.turned else (
            "upper face of the finished disc"
        )  # fmt: skip
        yield "cam axis at X {} Y {}, {} at Z {}".format(*places[:2], face, places[2])


def about_operation(cut: Cut, grid: Grid, zero: Zero, compensation: str = "") -> list[str]:
    """Comments on one operation; `compensation` is what the operator has to know of it."""
    depths = " ".join(grid.text(grid.steps(depth - zero.z)) for depth in cut.depths)
    return [f"operation {cut.name}", f"depths {depths}", compensation, cut.note]


def spelled(mm: float, unit: LengthUnit) -> str:
    """A length in the program's unit, and in mm if that is another."""
    text = f"{number(mm)} mm"
    return text if unit == "mm" else f"{number(mm / MM_PER[unit])} {unit}, {text}"


def commented(texts: Iterable[str], form: TextForm) -> list[str]:
    """`texts` as comment lines."""
    before, after = form.comment_open, form.comment_close
    return [before + line + after for line in comment_texts(texts, form)]


def comment_texts(texts: Iterable[str], form: TextForm) -> list[str]:
    """`texts` as the controller can read them in comments, wrapped: plain ASCII without brackets.

    Characters that it cannot read are replaced.
    """
    width = form.line_length - len(form.comment_open) - len(form.comment_close)
    if form.line_numbers is not None:
        width -= NUMBER_ROOM
    replaced = str.maketrans({"(": "[", ")": "]"} | dict.fromkeys(form.forbidden, "_"))
    lines = []
    for text in texts:
        plain = ascii_of(text).translate(replaced)
        plain = plain.upper() if form.letters == "upper" else plain
        lines += textwrap.wrap(plain, width)
    return lines


SPELLED = str.maketrans(
    {
        "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "ẞ": "SS",
        "Ø": "dia. ", "ø": "dia. ", "⌀": "dia. ", "Æ": "Ae", "æ": "ae", "Œ": "Oe", "œ": "oe",
        "Å": "Aa", "å": "aa", "Ł": "L", "ł": "l", "°": " deg", "±": "+-", "×": "x", "µ": "u",
        "μ": "u", "–": "-", "—": "-", "’": "'", "…": "...",
    }
)  # fmt: skip
"""Characters of technical texts as ASCII."""


def ascii_of(text: str) -> str:
    """`text` in ASCII: special letters and signs spelled out, accents left off, others as "?"."""
    spelled_out = unicodedata.normalize("NFC", text).translate(SPELLED)
    parts = unicodedata.normalize("NFKD", spelled_out)
    kept = "".join(each for each in parts if not unicodedata.combining(each))
    return kept.encode("ascii", "replace").decode("ascii")


@dataclass(frozen=True, slots=True, eq=False)
class Stated:
    """What the comments of a program state.

    Attributes
    ----------
    version : of camgeo, which wrote it; empty if they do not say so.
    scene : hash of the scene; empty if there is none.
    tolerance : [mm], or None.
    program : number from 1 where the machine needs one for each tool; 0 where it holds all.
    offsets : how far that of each compensated operation may be off [mm], in their order.
    second : whether it mills the second side.
    """

    version: str
    scene: str
    tolerance: float | None
    program: int = 0
    offsets: tuple[float, ...] = ()
    second: bool = False


def stated(notes: Iterable[str]) -> Stated:
    """What `notes`, the comments of a program without brackets, state; long ones may be wrapped."""
    lines = [note.strip() for note in notes]
    text = " ".join(lines)
    scene, tolerance = SCENE.search(text), TOLERANCE.search(text)
    named = (re.match(r"camgeo (\S+)", line, re.IGNORECASE) for line in lines)
    versions = [found[1].rstrip(",").lower() for found in named if found]
    return Stated(
        versions[0] if versions else "",
        scene.group(1).replace(" ", "")[:HASH_DIGITS].lower() if scene else "",
        length_of(tolerance.group(2).lower()) if tolerance else None,
        int(one.group(1)) if (one := ONE_OF.search(text)) else 0,
        tuple(_size(most) for _, most in OFFSET.findall(text)),
        any(line.lower().startswith(SECOND) for line in lines),
    )


def _size(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


# -- blocks ---------------------------------------------------------------------------------------
# Printed numbers, and the shares of the tolerance that they and the controller take.


FEED_DECIMALS = 4
"""Decimals of a number that no profile limits, trailing zeros dropped."""


@dataclass(frozen=True, slots=True)
class Grid:
    """Printed coordinates: whole multiples of the last decimal.

    Attributes
    ----------
    decimals : printed.
    mm_per_unit : of the program's unit of length.
    """

    decimals: int
    mm_per_unit: float

    @property
    def _scale(self) -> int:
        scale: int = 10**self.decimals
        return scale

    def steps(self, length: float) -> int:
        """`length` [mm] in units of the last decimal, rounded."""
        return round(length / self.mm_per_unit * self._scale)

    def mm(self, steps: int) -> float:
        """What a reader makes of the printed number [mm]."""
        return steps / self._scale * self.mm_per_unit

    def text(self, steps: int, *, signed: bool = False) -> str:
        """The printed number; zero has no minus, and a plus only if `signed`."""
        whole, part = divmod(abs(steps), self._scale)
        sign = "-" if steps < 0 else "+" if signed else ""
        return f"{sign}{whole}.{part:0{self.decimals}d}"


def number(value: float, decimals: int = FEED_DECIMALS) -> str:
    """A feed or a speed with as many digits as it has, but at most `decimals` behind the point."""
    return f"{value:.{decimals}f}".rstrip("0").rstrip(".")


CHORD_SHARE = 0.05
"""Share of the tolerance for arcs that are written as chords: nearly straight ones, and those whose
radius the machine does not accept."""

PROOF_SHARE = 0.05
"""Share of the tolerance left for the slack of the bound by which the program is measured."""

LEAST_FIT = 0.1
"""Least share of the tolerance left for the fit where numbers are coarse."""

SLACK = 1e-6
"""Of shares: messages name a tolerance with six digits."""

LINE_SHARE = 0.3
"""Share of the tolerance for chords on a machine that gets lines alone."""

TRUSTED_SHARE = 0.5
"""A controller whose own arcs take more of the tolerance than this gets lines instead of them."""


@dataclass(frozen=True, slots=True)
class Budget:
    """Shares of the tolerance; all lengths in mm.

    Attributes
    ----------
    tolerance : the whole.
    decimals : of the printed coordinates, in the program's unit.
    rounding : largest deviation by printing with these decimals.
    chord : largest sagitta of an arc written as chords.
    blending : the P of path blending, 0 for the exact path.
    fit : what is left for the cutter path's lines and arcs.
    interpolation : how far the controller's own path departs from an arc.
    arcs : whether arcs are written as such, if the machine takes them; else as chords.
    """

    tolerance: float
    decimals: int
    rounding: float
    chord: float
    blending: float
    fit: float
    interpolation: float = 0.0
    arcs: bool = True


def budget(machine: Machine, unit: LengthUnit, tolerance: float) -> Budget:
    """The shares of `tolerance` [mm] on `machine`."""
    decimals = machine.decimals(unit, tolerance)
    step = 10.0**-decimals
    rounding = ROUNDING_UNITS * step * MM_PER[unit]
    interpolation = machine.arcs.interpolation
    arcs = interpolation <= TRUSTED_SHARE * tolerance
    if not arcs:
        interpolation = 0.0
    chord = (CHORD_SHARE if arcs else LINE_SHARE) * tolerance
    left = tolerance * (1.0 - PROOF_SHARE) - rounding - chord - interpolation
    # Coarse numbers may leave too little for it.
    blending = machine.smoothed(tolerance, left - LEAST_FIT * tolerance) or 0.0
    # rounded down to what is printed
    blending = math.floor(blending / MM_PER[unit] / step + 1e-9) * step * MM_PER[unit]
    fit = left - blending
    # Blending takes no more than leaves this, up to a rounding. A tolerance that a message has
    # named as the least is enough.
    if left < (LEAST_FIT - SLACK) * tolerance and rounding > ROUNDING_SHARE * tolerance:
        least = rounding / (left + rounding - LEAST_FIT * tolerance) * tolerance
        message = f"{decimals} decimals in a program are too coarse"
        raise ToleranceError(message, tolerance, least)
    if fit <= 0.0:
        raise ToleranceError(
            "nothing of the tolerance is left for the fit", tolerance, tolerance - fit
        )
    return Budget(tolerance, decimals, rounding, chord, blending, fit, interpolation, arcs)
