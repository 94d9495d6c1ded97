"""Where the search for an exact root begins: at its guess, then at the root that was found."""

from __future__ import annotations

from dataclasses import dataclass, field

from camgeo.stability.high_precision import Number


@dataclass(frozen=True, slots=True)
class Roots:
    """Exact roots by their guesses.

    The first one is that of the inputs themselves. Half an ulp of an input moves it by next to
    nothing, so that one step leads from it where several lead from the guess.

    Attributes
    ----------
    decimals : of the guesses, which are told apart by them.
    """

    decimals: int
    _known: dict[float, Number] = field(default_factory=dict)

    def near(self, guess: Number) -> Number:
        """The root that is known for `guess`, or `guess` itself."""
        return self._known.get(self._key(guess), guess)

    def keep(self, guess: Number, root: Number) -> None:
        """Remember the first root of a guess."""
        self._known.setdefault(self._key(guess), root)

    def _key(self, guess: Number) -> float:
        return round(float(guess), self.decimals)
