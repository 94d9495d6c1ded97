"""Findings on milling programs of any origin, by line, and the data that such programs lack."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LineFinding:
    """A fault in one line of a program.

    Attributes
    ----------
    line : number of the line from 1; 0 for the program as a whole.
    rule : name of the rule that is broken, e.g. "arc-radius".
    concerns : subject of the rule: "words", "path", "form", "safety", "frame" or "limits"; "work"
        for the blank and the part of a scene.
    what : what is wrong, as a sentence without its full stop.
    value : value in the program, as text; empty if there is none.
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
class WorkData:
    """Data on the work that a program does not contain; lengths in mm.

    Attributes
    ----------
    stock_top : Z of the highest stock.
    clearance : Z above which traverses may go anywhere; None for `stock_top`.
    radii : radii of cutters by the number of their offset, for compensation by the control.
    operations : names of operations as they should be read, which comments may spell in other
        letters.
    """

    stock_top: float = 0.0
    clearance: float | None = None
    radii: tuple[tuple[int, float], ...] = ()
    operations: tuple[str, ...] = ()

    @property
    def free(self) -> float:
        """The height above which traverses may go anywhere."""
        return self.stock_top if self.clearance is None else max(self.clearance, self.stock_top)


@dataclass(frozen=True, slots=True)
class Linted:
    """One program with the findings on it.

    Attributes
    ----------
    findings : the findings, by line.
    texts : texts of the lines with findings, by their numbers.
    moves : number of moves that the program makes.
    complete : whether the program was read to its end, not only up to the last finding allowed.
    """

    findings: tuple[LineFinding, ...]
    texts: dict[int, str]
    moves: int
    complete: bool
