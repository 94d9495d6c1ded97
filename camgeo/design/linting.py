"""What is found in milling programs of any origin, by line, and what such programs do not say."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LineFinding:
    """What is wrong in one line of a program.

    Attributes
    ----------
    line : counted from 1; 0 for the program as a whole.
    rule : the name of what is broken, e.g. "arc-radius".
    concerns : "words", "path", "form", "safety", "frame" or "limits"; "work" if it is about the
        blank and the part of a scene.
    what : is wrong, a sentence without its full stop.
    value : that was found, as text; empty if there is none.
    allowed : what would be right; empty if `what` says so.
    """

    line: int
    rule: str
    concerns: str
    what: str
    value: str = ""
    allowed: str = ""

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line else ""
        value = f", {self.value}" if self.value else ""
        allowed = f"; allowed: {self.allowed}" if self.allowed else ""
        return f"{place}{self.what}{value}{allowed}"


@dataclass(frozen=True, slots=True)
class Bench:
    """What a program does not say of the work; lengths in mm.

    Attributes
    ----------
    stock_top : Z of the highest stock.
    clearance : Z from which on traverses may go anywhere; None for `stock_top`.
    radii : of cutters by the number of their offset, for compensation that the control computes.
    operations : names that its comments may have in other letters, as they should be read.
    """

    stock_top: float = 0.0
    clearance: float | None = None
    radii: tuple[tuple[int, float], ...] = ()
    operations: tuple[str, ...] = ()

    @property
    def free(self) -> float:
        """The height from which on traverses may go anywhere."""
        return self.stock_top if self.clearance is None else max(self.clearance, self.stock_top)


@dataclass(frozen=True, slots=True)
class Linted:
    """One program with what was found in it.

    Attributes
    ----------
    findings : by line.
    texts : of the lines with findings, by their numbers.
    moves : how many it makes.
    complete : whether it was read to its end, not only up to the last finding allowed.
    """

    findings: tuple[LineFinding, ...]
    texts: dict[int, str]
    moves: int
    complete: bool
