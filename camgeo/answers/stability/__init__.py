"""What `camgeo stability` finds: rounding errors and conditioning of every quantity."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from typing import ClassVar

from camgeo.answers.answer import BROKEN, FINE, Answer
from camgeo.stability import suite
from camgeo.stability.measure import Case, Reading
from camgeo.stability.suite import LIMIT, Row


@dataclass(frozen=True, slots=True)
class Stability(Answer):
    """The results of the comparison with mpmath.

    Attributes
    ----------
    readings : one for each value that was compared.
    rows : the quantities with their worst readings, the largest ratio first.
    quick : whether only two places of each case were compared.
    limit : of the ratio of error to conditioning.
    """

    command: ClassVar[str] = "stability"

    readings: tuple[Reading, ...]
    rows: tuple[Row, ...]
    quick: bool
    limit: float = LIMIT

    @property
    def kept(self) -> bool:
        """Whether all ratios are within the limit."""
        return all(row.within_limit for row in self.rows)

    @property
    def exit_code(self) -> int:
        """0 if all ratios are within the limit, else 1."""
        return FINE if self.kept else BROKEN


def stability(
    cases: Iterable[Case],
    only: Collection[str] = (),
    *,
    quick: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Stability:
    """Run cases of the suite; parameters as of `camgeo.stability.suite.run`."""
    readings = suite.run(cases, only, quick=quick, progress=progress)
    return Stability(readings, suite.table(readings), quick)
