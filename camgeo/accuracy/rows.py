"""The rows measured: one for each form of the contour, each solid, table step and effect."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass, replace
from decimal import Decimal
from typing import Any, Final

from camgeo.contour.contour import Effort, Form

FORMS: Final[tuple[Form, ...]] = ("polyline", "arcs", "spline")
"""Forms of a contour, named by the entities of a drawing."""

EFFORTS: Final[tuple[Effort, ...]] = ("fewest", "fast")

ORDER: Final[dict[Form, int]] = {"polyline": 2, "arcs": 3, "spline": 4}
"""The number of pieces of a form grows with the power -1/order of the tolerance."""


@dataclass(frozen=True, slots=True)
class Count:
    """The contours of all flanks in use, fitted and proved.

    Attributes
    ----------
    pieces : of all flanks together.
    forced : those of them for dwells and turns, needed at any tolerance.
    least : asymptotic limit of the others for small tolerances, see `camgeo.contour.least_pieces`.
    deviation : proved [mm], the largest.
    fit_seconds, proof_seconds : of the fits with their own proof, and of proofs repeated from
        the finished contours alone.
    spread : of both, as `camgeo.accuracy.clock.Timing`.
    """

    pieces: int
    forced: int
    least: float
    deviation: float
    fit_seconds: float
    proof_seconds: float
    spread: float = 1.0

    @property
    def ratio(self) -> float | None:
        """Pieces that are not forced, as a multiple of the limit; None where the limit is 0."""
        return (self.pieces - self.forced) / self.least if self.least > 0.0 else None


@dataclass(frozen=True, slots=True)
class FileCost:
    """A file written and read back.

    Attributes
    ----------
    size : in bytes.
    deviation : proved for the file as read back [mm]; None if it has none.
    write_seconds, read_seconds : of writing it, fits included, and of reading it back and proving.
    facts : what its writer reports about it.
    spread : of these seconds without the fits of a drawing, as `camgeo.accuracy.clock.Timing`.
    """

    size: int
    deviation: float | None
    write_seconds: float
    read_seconds: float
    facts: dict[str, int | float | str]
    spread: float = 1.0

    @property
    def seconds(self) -> float:
        """Of writing and reading it."""
        return self.write_seconds + self.read_seconds


@dataclass(frozen=True, slots=True)
class ContourRow:
    """One form of the contour at one tolerance.

    Attributes
    ----------
    form, effort, tolerance : as requested; the tolerance in mm.
    count : of the contours; None if there are none.
    drawing : the DXF with that entity; None if there is none.
    program : the G-code, if it was asked for, for arcs only and if the scene asks for milling.
    round_seconds : estimated time of milling once along the flanks; None for splines, and where the
        machine's acceleration is not known.
    ripple : largest error of the acceleration in a replay, relative to its prescribed peak; None if
        it was not requested, and for splines.
    shortest_seconds : time of the round at the largest feed that the controller can hold.
    fault : why something is missing; empty if nothing is.
    decimals : of a program within that tolerance; None if the scene does not ask for one.
    """

    form: Form
    effort: Effort
    tolerance: float
    count: Count | None = None
    drawing: FileCost | None = None
    program: FileCost | None = None
    round_seconds: float | None = None
    ripple: float | None = None
    shortest_seconds: float | None = None
    fault: str = ""
    decimals: int | None = None

    @property
    def spread(self) -> float:
        """Of what the drawing takes: the larger one of its fits and of its file."""
        return max((each.spread for each in (self.count, self.drawing) if each), default=1.0)


@dataclass(frozen=True, slots=True)
class SolidRow:
    """A solid at one tolerance; `fault` states why there is no `file`."""

    format: str
    tolerance: float
    file: FileCost | None = None
    fault: str = ""


@dataclass(frozen=True, slots=True)
class TableRow:
    """The value table at one step.

    Attributes
    ----------
    step : [degrees].
    rows, size : of the table, and of its CSV file in bytes.
    seconds : of computing it.
    error : bound on the error of the lift interpolated linearly between rows [mm or rad].
    spread : of the seconds, as `camgeo.accuracy.clock.Timing`.
    """

    step: Decimal
    rows: int
    size: int
    seconds: float
    error: float
    spread: float = 1.0


@dataclass(frozen=True, slots=True)
class EffectRow:
    """A numerical effect at one tolerance.

    Attributes
    ----------
    effect : its name.
    tolerance : requested, relative to the scale of each figure, see `camgeo.effects.effect.Bound`.
    seconds : of computing it, without the effects that it needs; None if it has no answer.
    error : its own estimate, the largest of all figures, relative likewise; None if it is exact.
    difference : the largest of all figures from a result to a tolerance at most a hundredth of
        this, relative likewise; None where there is no such result.
    fault : why it has no answer, or which figures are off by more than estimated; else empty.
    figure : name of the finding or column with this difference; empty if it is 0.
    rounded : whether estimate and difference are those of rounding. The effect then has no further
        rows, as no tolerance changes it.
    spread : of the seconds, as `camgeo.accuracy.clock.Timing`.
    """

    effect: str
    tolerance: float
    seconds: float | None = None
    error: float | None = None
    difference: float | None = None
    fault: str = ""
    figure: str = ""
    rounded: bool = False
    spread: float = 1.0


def in_length(row: Any, mm: float, moved: float = 1.0) -> Any:
    """A row with its tolerance, and what it has of deviations, in units of `mm`; octaves of the
    acceleration in units of `moved`.
    """
    found: dict[str, Any] = {}
    for each in fields(row):
        value = getattr(row, each.name)
        if is_dataclass(value):
            found[each.name] = in_length(value, mm, moved)
        elif each.name in ("tolerance", "deviation") and value is not None:
            found[each.name] = value / mm
        elif each.name == "octaves":
            found[each.name] = tuple(octave / moved for octave in value)
    return replace(row, **found)
