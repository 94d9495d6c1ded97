"""Instances by their types, with the parameters that geometry needs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from camgeo_export.errors import FileError
from camgeo_export.part21.text import Exchange, Record, Ref, Word

Kind = TypeVar("Kind")


@dataclass(frozen=True, slots=True)
class Entity:
    """One type of an instance, with its parameters by their places."""

    number: int
    kind: str
    values: tuple[Any, ...]

    def fault(self, message: str) -> FileError:
        """An error that names it."""
        return FileError(f"#{self.number}, {self.kind}: {message}")

    def _of(self, place: int, kind: type[Kind], what: str) -> Kind:
        found = self.values[place] if place < len(self.values) else None
        if not isinstance(found, kind):
            raise self.fault(f"parameter {place + 1} is not {what}")
        return found

    def ref(self, place: int) -> Ref:
        """A reference."""
        return self._of(place, Ref, "a reference")

    def text(self, place: int) -> str:
        """A text."""
        return self._of(place, str, "a text")

    def word(self, place: int) -> str:
        """An enumeration."""
        return self._of(place, Word, "an enumeration")

    def flag(self, place: int) -> bool:
        """A truth value."""
        found = self.word(place)
        if found not in ("T", "F"):
            raise self.fault(f"parameter {place + 1} is not .T. or .F.")
        return found == "T"

    def number_at(self, place: int) -> float:
        """A number."""
        return self._number(self.values[place] if place < len(self.values) else None, place)

    def measure(self, place: int) -> float:
        """The number in a measure that names its type."""
        found = self._of(place, Record, "a measure")
        return self._number(found.values[0] if len(found.values) == 1 else None, place)

    def _number(self, value: Any, place: int) -> float:
        if isinstance(value, Ref) or not isinstance(value, int | float):
            raise self.fault(f"parameter {place + 1} is not a number")
        return float(value)

    def row(self, place: int) -> tuple[Any, ...]:
        """A list."""
        return self._of(place, tuple, "a list")

    def refs(self, place: int) -> tuple[Ref, ...]:
        """A list of references."""
        found = self.row(place)
        if not all(isinstance(each, Ref) for each in found):
            raise self.fault(f"parameter {place + 1} is not a list of references")
        return found

    def numbers(self, place: int) -> list[float]:
        """A list of numbers."""
        return [self._number(each, place) for each in self.row(place)]


@dataclass(frozen=True, slots=True)
class Model:
    """The instances of a file."""

    instances: dict[int, tuple[Record, ...]]

    @classmethod
    def of(cls, exchange: Exchange) -> Model:
        """The model of a file; FileError if an instance refers to one that is not there."""
        for number, records in exchange.instances.items():
            for ref in references(records):
                if ref not in exchange.instances:
                    raise FileError(f"#{number} refers to #{ref}, which is not there")
        return cls(exchange.instances)

    def entity(self, ref: int, *kinds: str) -> Entity:
        """An instance as the first of `kinds` that it is; FileError if it is none of them."""
        records = {record.kind: record for record in self.instances[ref]}
        for kind in kinds:
            if kind in records:
                return Entity(ref, kind, records[kind].values)
        raise FileError(f"#{ref} is {' '.join(records) or 'nothing'}, not {' or '.join(kinds)}")

    def is_a(self, ref: int, kind: str) -> bool:
        """Whether an instance is of a type."""
        return any(record.kind == kind for record in self.instances[ref])

    def all_of(self, *kinds: str) -> list[Entity]:
        """All instances of these types, in the order of the file."""
        return [
            Entity(number, record.kind, record.values)
            for number, records in self.instances.items()
            for record in records
            if record.kind in kinds
        ]

    def reached(self, *first: int) -> set[int]:
        """The numbers of instances to which these lead, themselves included."""
        found, left = set(first), list(first)
        while left:
            for ref in references(self.instances[left.pop()]):
                if ref not in found:
                    found.add(ref)
                    left.append(ref)
        return found


def references(records: tuple[Record, ...]) -> Iterator[Ref]:
    """All references in the parameters of records."""
    left: list[Any] = list(records)
    while left:
        each = left.pop()
        if isinstance(each, Ref):
            yield each
        elif isinstance(each, tuple):
            left.extend(each)
        elif isinstance(each, Record):
            left.extend(each.values)
