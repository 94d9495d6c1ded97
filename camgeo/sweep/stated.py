"""The family that a scene states in a table, or a command line in its options."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Any

from camgeo.scene.scene import Scene
from camgeo.scene.varied import SWEEP, keys_in, rows_of
from camgeo.sweep.family import Family, Sample
from camgeo.sweep.variables import Listed, Range, Variable, listed, parse, spaced


def family_of(
    scene: Scene, vary: Sequence[str | Variable] = (), sample: Sample | None = None
) -> Family:
    """The family of a scene.

    Parameters
    ----------
    vary : variables, or text as of `--vary`; if there are none, those that the scene states.
    sample : how designs are drawn; None for all combinations, or, if the scene's variables are
        used, for what it states.

    Raises
    ------
    SceneError, GeometryError
        As `Family`.
    """
    table = scene.values.get(SWEEP, {})
    if not vary and sample is None and "samples" in table:
        sample = Sample(
            int(table["samples"]), table.get("method", "sobol"), int(table.get("seed", 0))
        )
    variables = tuple(_parsed(vary)) if vary else variables_in(scene, SWEEP)
    return Family(scene, variables, sample)


def variables_in(scene: Scene, name: str) -> tuple[Variable, ...]:
    """The variables that the scene states in the table of that name, which its rules have checked;
    none if there is no such table.
    """
    return tuple(_stated(scene.values.get(name, {}).get("vary", ())))


def questions_of(scene: Scene, ask: Iterable[str] = ()) -> tuple[str, ...]:
    """The names of what is asked, of which each text may have several, comma-separated.

    If there are none, those that the scene states.
    """
    return names_in(ask) or tuple(scene.values.get(SWEEP, {}).get("ask", ()))


def names_in(texts: Iterable[str]) -> tuple[str, ...]:
    """All names in texts, of which each may have several, comma-separated."""
    return tuple(word.strip() for text in texts for word in text.split(",") if word.strip())


def _parsed(vary: Iterable[str | Variable]) -> Iterator[Variable]:
    return (parse(each) if isinstance(each, str) else each for each in vary)


def _stated(tables: Iterable[Mapping[str, Any]]) -> Iterator[Variable]:
    """The variables of tables as `[[sweep.vary]]`."""
    for table in tables:
        keys = keys_in(table)
        yield Variable(keys, _values(keys, table))


def _values(keys: tuple[str, ...], table: Mapping[str, Any]) -> Listed | Range:
    if "values" in table:
        return listed(keys[0], rows_of(table["values"], len(keys)), len(keys))
    steps = table.get("count")
    start, stop = Decimal(table["from"]), Decimal(table["to"])
    return spaced(keys[0], start, stop, None if steps is None else int(steps), len(keys))
