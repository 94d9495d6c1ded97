"""Values checked on input: each is valid, or a `GeometryError` states what is wrong.

Whole numbers, fractions and numpy's scalars are numbers and become floats; truth values, text and
complex numbers are rejected. Products of a few lengths must neither overflow nor vanish, so no
number may be larger than `LARGEST`, and no positive one smaller than `SMALLEST`.
"""

from __future__ import annotations

import math
import reprlib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import is_dataclass
from decimal import Decimal
from functools import cache, partial
from numbers import Complex, Integral, Real
from types import MappingProxyType, NoneType, UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    Final,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np
from numpy.typing import DTypeLike

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen

SMALLEST: Final = 1e-30
LARGEST: Final = 1e30

LONGEST: Final = 60
"""Number of characters of a value that messages show."""

Choice = TypeVar("Choice", str, int, float)
Kind = TypeVar("Kind")

Check = Callable[[str, Any], Any]
"""From key and value to the value as stored; raises GeometryError if the value is invalid."""


def number(
    key: str,
    value: Any,
    *,
    above: float | None = None,
    least: float | None = None,
    below: float | None = None,
    most: float | None = None,
    unit: str = "",
    largest: float = LARGEST,
) -> float:
    """`value` as a float, between the bounds: `above` and `below` are excluded, the others allowed.

    `largest` bounds the magnitude, so that no product of such values overflows; it differs from
    the default for values that enter products less or more often than lengths do.

    Raises
    ------
    GeometryError
        With `key`, the value, and the allowed range in `unit`.
    """
    real = _float(value)
    if not (
        math.isfinite(real)
        and (above is None or real > above)
        and (least is None or real >= least)
        and (below is None or real < below)
        and (most is None or real <= most)
    ):
        raise GeometryError(_allowed(above, least, below, most, unit), key, value_text(value))
    if abs(real) > largest:
        raise GeometryError(f"must be at most {largest:g} in magnitude", key, value_text(value))
    if above == 0.0 and real < SMALLEST:
        raise GeometryError(f"must be at least {SMALLEST:g}", key, value_text(value))
    return real


def finite(key: str, value: Any, unit: str = "") -> float:
    """`value` as a float; GeometryError unless it is a finite number."""
    return number(key, value, unit=unit)


def positive(key: str, value: Any, unit: str = "") -> float:
    """`value` as a float; GeometryError unless it is a number above 0."""
    return number(key, value, above=0.0, unit=unit)


def decimal(
    key: str, value: Any, least: Decimal, most: Decimal, unit: str = "", what: str = "number"
) -> Decimal:
    """`value` as a decimal number from `least` to `most`, whose multiples are exact.

    A float counts as the decimal number that Python prints for it: 0.2 is 0.2.

    Raises
    ------
    GeometryError
        With `key`, the value, and the allowed range of `what` in `unit`.
    """
    if isinstance(value, Decimal):
        exact = value
    elif math.isfinite(number := _float(value)):
        exact = Decimal(int(value) if isinstance(value, Integral) else repr(number))
    else:
        exact = Decimal("NaN")
    if exact.is_finite() and least <= exact <= most:
        return exact
    allowed = f"must be a {what} from {least:f} to {most:f}"
    raise GeometryError(
        f"{allowed} ({unit})" if unit else allowed,
        key,
        str(value) if isinstance(value, Decimal) else value_text(value),
    )


def point(key: str, value: Any, unit: str = "") -> complex:
    """`value` as a point x + i y; GeometryError unless both are finite numbers."""
    if isinstance(value, bool) or not isinstance(value, Complex):
        raise GeometryError("must be a point x + i y, a complex number", key, value_text(value))
    return complex(finite(key, value.real, unit), finite(key, value.imag, unit))


def whole(key: str, value: Any, least: int, most: int) -> int:
    """`value` as an int; GeometryError unless it is a whole number from `least` to `most`."""
    if isinstance(value, Integral) and least <= _float(value) <= most:
        return int(value)
    raise GeometryError(f"must be a whole number from {least} to {most}", key, value_text(value))


def one_of(key: str, value: Any, choices: Sequence[Choice]) -> Choice:
    """The one of `choices`, texts or numbers, that equals `value`; GeometryError if none does."""
    if isinstance(value, str | Real) and not isinstance(value, bool):
        for choice in choices:
            if choice == value:
                return choice
    allowed = ", ".join(repr(choice).replace("'", '"') for choice in choices)
    raise GeometryError(f"must be one of {allowed}", key, value_text(value))


def among(value: object, names: Collection[str]) -> bool:
    """Whether `value` is one of `names`; `value` may be any object."""
    return isinstance(value, str) and value in names


def instance(key: str, value: Any, kind: type[Kind] | tuple[type[Kind], ...], what: str) -> Kind:
    """`value`; GeometryError unless it is of the class `kind`, which messages call `what`."""
    if not isinstance(value, kind):
        raise GeometryError(f"must be {what}", key, value_text(value))
    return value


def instances(key: str, values: Any, kinds: tuple[type, ...], what: str) -> tuple[Any, ...]:
    """`values` as a tuple; GeometryError unless they are a sequence of objects of these classes."""
    for value in instance(key, values, Sequence, f"a sequence of {what}"):
        if not isinstance(value, kinds):
            raise GeometryError(f"must be a sequence of {what}", key, value_text(value))
    return tuple(values)


def optional(key: str, value: Any, unit: str = "") -> float | None:
    """`value` as a float, or None; GeometryError unless it is a finite number or None."""
    return None if value is None else finite(key, value, unit)


def by_name(key: str, values: Any, largest: float = LARGEST) -> Mapping[str, float]:
    """`values` as a read-only mapping of names to finite numbers; GeometryError if it is not one.

    In messages the key of a number is its own name.
    """
    mapping = instance(key, values, Mapping, "numbers by name")
    names = [instance(key, name, str, "numbers by name") for name in mapping]
    return MappingProxyType({name: number(name, mapping[name], largest=largest) for name in names})


def array(key: str, values: Any, dimensions: int = 1, largest: float = LARGEST) -> FloatArray:
    """`values` as a read-only array of finite numbers; GeometryError if they are not."""
    try:
        numbers = np.array(values)
    except (ValueError, OverflowError):  # rows of unequal length
        numbers = np.empty(())
    if numbers.dtype.kind not in "iuf" or numbers.ndim != dimensions:
        shape = "a row of numbers" if dimensions == 1 else "rows of numbers of equal length"
        raise GeometryError(f"must be {shape}", key, value_text(values))
    numbers = numbers.astype(np.float64, copy=False)
    # Negated, so that a NaN, which compares as false, is wrong too.
    wrong = np.flatnonzero(~(np.abs(numbers) <= largest))
    if len(wrong):
        raise GeometryError(
            f"must be finite numbers, at most {largest:g} in magnitude; number {wrong[0] + 1} of"
            " them is not",
            key=key,
            value=repr(float(numbers.ravel()[wrong[0]])),
        )
    numbers.flags.writeable = False
    return numbers


def check_fields(owner: object, path: str = "") -> None:
    """Check the fields of a frozen dataclass under construction against their annotations.

    A field of the type `Annotated[float, positive]` becomes what `positive` returns for it; its key
    is `path` and its name, or the text after the check. A field annotated with a dataclass must be
    an instance of it. With `| None` it may also be None.
    """
    kind: Any = type(owner)  # a class is hashable, though mypy denies it
    for name, (check, key, optional) in field_checks(kind).items():
        value = getattr(owner, name)
        if value is not None or not optional:
            hold(owner, **{name: check(path + key, value)})


class CheckedFields:
    """Base of a frozen dataclass whose fields are checked on construction, see `check_fields`.

    The keyword `path` of the subclass is what the keys in messages begin with.
    """

    __slots__ = ()
    _path: ClassVar[str] = ""

    def __init_subclass__(cls, *, path: str | None = None) -> None:
        if path is not None:  # a class is made again, without it, for its slots
            cls._path = path

    def __post_init__(self) -> None:
        check_fields(self, self._path)


@cache
def field_checks(kind: type) -> Mapping[str, tuple[Check, str, bool]]:
    """The check, the key and whether None is allowed, for each field that has a check."""
    checks: dict[str, tuple[Check, str, bool]] = {}
    for name, hint in get_type_hints(kind, include_extras=True).items():
        kinds = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
        for alternative in kinds:
            if isinstance(alternative, type) and is_dataclass(alternative):
                check = partial(instance, kind=alternative, what=f"a `{alternative.__name__}`")
                checks[name] = check, name, NoneType in kinds
            elif get_origin(alternative) is Annotated:
                _, check, *key = get_args(alternative)
                checks[name] = check, *(key or [name]), NoneType in kinds
    return checks


def instance_from_table(kind: type[Kind], table: Mapping[str, Any]) -> Kind:
    """An object of the dataclass `kind` from a table whose keys are the names of its fields.

    A nested table becomes an object of its field's type, a list a tuple, or a point where the field
    is one, and a decimal number a float or a whole number. Raises what the constructor raises.
    """
    values, known = dict(table), cast("Any", kind)  # which is hashable, though mypy denies it
    for name, hint in _hints(known).items():
        if name in values:
            values[name] = _field_value(hint, values[name])
    return kind(**values)


@cache
def _hints(kind: type) -> dict[str, Any]:
    """The types of the fields of a dataclass."""
    return get_type_hints(kind)


def _field_value(hint: Any, value: Any) -> Any:
    """`value` of a table, converted to what a field with the type `hint` takes."""
    kinds = (hint, *get_args(hint))
    inner = next((candidate for candidate in kinds if is_dataclass(candidate)), None)
    if isinstance(value, Mapping) and isinstance(inner, type):
        return instance_from_table(inner, value)
    if isinstance(value, list | tuple):
        if complex in kinds:
            # A point stands in a table as the list [x, y].
            return complex(*value)
        return tuple(_field_value(inner, entry) for entry in value)
    kind = next((candidate for candidate in (float, int) if candidate in kinds), None)
    return kind(value) if kind and isinstance(value, Decimal) else value


def hold(owner: object, /, **values: Any) -> None:
    """Set fields of a frozen dataclass under construction to their checked values."""
    for name, value in values.items():
        object.__setattr__(owner, name, value)


def value_text(value: Any) -> str:
    """`value` as a message shows it, shortened to `LONGEST` characters."""
    number = _float(value)
    if not math.isnan(number):
        return repr(number)
    text = value if isinstance(value, str) else reprlib.repr(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def _float(value: Any) -> float:
    """`value` as a float; NaN if it is not a number."""
    if type(value) is float:  # nearly always, and asking for `Real` takes far longer
        return value
    # True and False are whole numbers in Python, but not in a scene.
    if isinstance(value, bool) or not isinstance(value, Real):
        return math.nan
    try:
        return float(value)
    except OverflowError:  # of a whole number or a fraction
        return -math.inf if value < 0 else math.inf


def _allowed(
    above: float | None,
    least: float | None,
    below: float | None,
    most: float | None,
    unit: str,
) -> str:
    """The allowed range between these bounds, as text."""
    low = f" above {above:g}" if above is not None else ""
    low = f" from {least:g}" if least is not None else low
    high = f"{' and' if low else ''} below {below:g}" if below is not None else ""
    high = f"{' ' if low else ' up '}to {most:g}" if most is not None else high
    text = f"must be a {'' if low or high else 'finite '}number{low}{high}"
    return f"{text} ({unit})" if unit else text


def _frozen(dtype: DTypeLike) -> Check:
    return lambda _, value: frozen(value, dtype)


# As types of fields, see `check_fields`.
Finite = Annotated[float, finite]
Positive = Annotated[float, positive]
Truth = Annotated[bool, partial(instance, kind=bool, what="true or false")]
Row = Annotated[FloatArray, array]

# Arrays of any numbers and of any shape, which become read-only.
Floats = Annotated[FloatArray, _frozen(np.float64)]
Complexes = Annotated[ComplexArray, _frozen(np.complex128)]
Integers = Annotated[IntArray, _frozen(np.intp)]
Truths = Annotated[BoolArray, _frozen(np.bool_)]
