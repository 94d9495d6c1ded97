"""The family that a scene states in `[sweep]`, or a command line in its options."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from camgeo.scene.scene import Scene
from camgeo.sweep.family import Family, Sample
from camgeo.sweep.variables import Variable, parse


def family_of(
    scene: Scene, vary: Sequence[str | Variable] = (), sample: Sample | None = None
) -> Family:
    """The family of a scene.

    Parameters
    ----------
    vary : variables, or text as of `--vary`.
    sample : how designs are drawn; None for all combinations.

    Raises
    ------
    SceneError, GeometryError
        As `Family`.
    """
    return Family(scene, tuple(_variables(vary)), sample)


def _variables(vary: Iterable[str | Variable]) -> Iterable[Variable]:
    return (parse(each) if isinstance(each, str) else each for each in vary)


def words_of(ask: Iterable[str]) -> tuple[str, ...]:
    """The names of what is asked, of which each text may have several, comma-separated."""
    return tuple(word.strip() for text in ask for word in text.split(",") if word.strip())
