"""What is measured: a row for each form of the contour, each solid, table step and effect."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Final, Literal

from camgeo.contour.contour import Effort

Form = Literal["polyline", "arcs", "spline"]

FORMS: Final[tuple[Form, ...]] = ("polyline", "arcs", "spline")
"""Forms of a contour, the names of the entities of a drawing."""

EFFORTS: Final[tuple[Effort, ...]] = ("fewest", "fast")

ORDER: Final[dict[Form, int]] = {"polyline": 2, "arcs": 3, "spline": 4}
"""The pieces of a form grow with the power -1/order of the tolerance."""


@dataclass(frozen=True, slots=True)
class Count:
    """The contours of all flanks in use, fitted and proved.

    Attributes
    ----------
    pieces : of all flanks together.
    forced : pieces among them that dwells and turns are, whatever the tolerance.
    least : limit of the others for small tolerances, see `camgeo.contour.least_pieces`.
    deviation : proved [mm], the largest.
    fit_seconds, proof_seconds : of the fits with their own proof, and of the proofs again from
        the finished contours alone.
    """

    pieces: int
    forced: int
    least: float
    deviation: float
    fit_seconds: float
    proof_seconds: float

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
    write_seconds, read_seconds : of writing it, fits among it, and of reading it back and proving.
    facts : what its writer says of it.
    """

    size: int
    deviation: float | None
    write_seconds: float
    read_seconds: float
    facts: dict[str, int | float | str]


@dataclass(frozen=True, slots=True)
class ContourRow:
    """One form of the contour at one tolerance.

    Attributes
    ----------
    form, effort, tolerance : what was asked; the tolerance in mm.
    count : of the contours; None if they cannot be had.
    drawing : the DXF with that entity; None if it cannot be had.
    program : the G-code, for arcs only and if the scene asks for milling.
    round_seconds : estimated time of milling once along the flanks; None for splines, and where the
        machine's acceleration is not known.
    ripple : largest error of the acceleration in a replay, as a share of its demanded peak; None if
        it was not asked for, and for splines.
    fault : why something is missing, or empty.
    """

    form: Form
    effort: Effort
    tolerance: float
    count: Count | None = None
    drawing: FileCost | None = None
    program: FileCost | None = None
    round_seconds: float | None = None
    ripple: float | None = None
    fault: str = ""


@dataclass(frozen=True, slots=True)
class SolidRow:
    """A solid at one tolerance; `fault` says why there is no `file`."""

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
    seconds : of making it.
    error : bound of the error of the lift between rows if it is interpolated linearly [mm or rad].
    """

    step: Decimal
    rows: int
    size: int
    seconds: float
    error: float


@dataclass(frozen=True, slots=True)
class EffectRow:
    """A numerical effect at one tolerance.

    Attributes
    ----------
    effect : its name.
    tolerance : asked, as a share of the largest magnitude of what the effect gives.
    seconds : of computing it, without the effects that it needs; None if it has no answer.
    error : that it estimates itself, as such a share; None if it gives none.
    difference : from the result at the tightest tolerance that has an answer, as such a share; None
        for that one, and where the two cannot be compared.
    fault : why it has no answer, or empty.
    """

    effect: str
    tolerance: float
    seconds: float | None = None
    error: float | None = None
    difference: float | None = None
    fault: str = ""
