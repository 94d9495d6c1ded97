"""Checks of the values in a machine profile, and the types of its fields."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from string import Formatter
from types import MappingProxyType
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.numeric.checked import instance, number, one_of, shown, whole
from camgeo.toolpath.spec import LONGEST_SPIN_UP

SMALLEST_SWEEP, LARGEST_SWEEP = 1.0, 180.0
"""No arc of a program exceeds half a turn [degrees], beyond which controllers are strict. No
controller needs finely divided arcs."""

MOST_DECIMALS: Final = 10
"""More decimals than a controller's double holds for a length of metres."""

MOST_SHOWN: Final = 60
"""Characters shown of a block."""

LONGEST_LINE: Final = 10_000
"""Characters; no controller accepts as many."""

EVIDENCE: Final = ("manual", "source code", "interpreter", "machine", "post", "none")
"""What a statement of a profile rests on, the best first."""

MEANINGS: Final = (
    "rapid", "line", "clockwise arc", "counter-clockwise arc", "holes", "bores", "dwell",
    "plane XY", "plane ZX", "plane YZ", "inch", "mm", "compensation off", "compensation left",
    "compensation right", "length offset", "length offset off", "machine position", "home",
    "work offset", "exact stop", "exact path", "continuous path", "cycle off", "motion off",
    "absolute", "incremental", "absolute centres", "incremental centres", "inverse time",
    "feed per minute", "feed per revolution", "smoothing", "stop", "optional stop", "end",
    "spindle clockwise", "spindle counter-clockwise", "spindle off", "return to start",
    "return to R", "tool change", "flood", "mist", "through", "coolant off", "no effect",
    "not read",
)  # fmt: skip
"""Meanings of G and M words that a profile can give to a word of another common meaning; a word
"not read" is accepted, but programs with it cannot be judged."""


def texts(key: str, given: Any) -> tuple[str, ...]:
    """`given` as a tuple of texts; GeometryError if it is not a list of them."""
    if isinstance(given, list | tuple) and all(isinstance(line, str) for line in given):
        return tuple(given)
    raise GeometryError("must be a list of texts", key, shown(given))


def blocks_with(*names: str) -> Any:
    """The check of blocks that may have `names` in braces."""
    return partial(blocks_of, names=names)


def blocks_of(key: str, given: Any, names: tuple[str, ...]) -> tuple[str, ...]:
    """`given` as blocks; GeometryError for braces around anything but `names`."""
    blocks = texts(key, given)
    for block in blocks:
        try:
            found = [each for each in Formatter().parse(block) if each[1] is not None]
        except ValueError:
            found = [("", None, None, None)]
        if any(name not in names or form or kind for _, name, form, kind in found):
            allowed = f" but {', '.join(f'{{{each}}}' for each in names)}" if names else ""
            message = f"must hold no braces{allowed}"
            raise GeometryError(message, key, repr(block[:MOST_SHOWN]))
    return blocks


def codes(key: str, given: Any) -> tuple[float, ...]:
    """`given` as the numbers of G or M words; GeometryError if they are none."""
    instance(key, given, tuple, "a tuple of numbers")
    return tuple(number(key, each, least=0.0, most=9999.0) for each in given)


def offsets(key: str, given: Any) -> Mapping[str, str]:
    """Work offsets by name, each with its block, read-only; GeometryError if there is none."""
    table = instance(key, given, Mapping, "a table of names with their blocks")
    if not table:
        raise GeometryError("must name at least one", key, shown(given))
    found = {name: instance(f"{key}.{name}", table[name], str, "a text") for name in table}
    for name, block in found.items():
        blocks_of(f"{key}.{name}", (block,), ())
    return MappingProxyType(found)


def meanings(key: str, given: Any) -> Mapping[str, str]:
    """Words with their `MEANINGS`, read-only; GeometryError for another one."""
    table = instance(key, given, Mapping, "a table of words with their meanings")
    if not table:
        raise GeometryError("must name at least one", key, shown(given))
    found = {word: one_of(f"{key}.{word}", table[word], MEANINGS) for word in table}
    return MappingProxyType(found)


Text = Annotated[str, partial(instance, kind=str, what="a text")]
Flag = Annotated[bool, partial(instance, kind=bool, what="true or false")]
Texts = Annotated[tuple[str, ...], texts]
Plain = Annotated[tuple[str, ...], blocks_with()]
Size = Annotated[float, partial(number, least=0.0)]
LineLength = Annotated[int, partial(whole, least=1, most=LONGEST_LINE)]
DecimalCount = Annotated[int, partial(whole, least=1, most=MOST_DECIMALS)]
Sweep = Annotated[float, partial(number, least=SMALLEST_SWEEP, most=LARGEST_SWEEP)]
Share = Annotated[float, partial(number, least=0.0, most=0.9)]
Seconds = Annotated[float, partial(number, least=0.0, most=LONGEST_SPIN_UP, unit="s")]
Codes = Annotated[tuple[float, ...], codes]
Meanings = Annotated[Mapping[str, str], meanings]
WorkOffsets = Annotated[Mapping[str, str], offsets]
