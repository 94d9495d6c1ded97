"""The arguments of jobs, checked at their door."""

from __future__ import annotations

import math

from camgeo.designing.job import Job, JobError


class Arguments:
    """The arguments of a job; each method raises JobError unless the argument is as it must be."""

    def __init__(self, job: Job) -> None:
        self._given = job.arguments
        self._kind = job.kind

    def flag(self, name: str, *, otherwise: bool) -> bool:
        """True or false; `otherwise` if it is not given."""
        value = self._given.get(name, otherwise)
        if not isinstance(value, bool):
            raise self._wrong(name, "true or false")
        return value

    def number(self, name: str) -> float | None:
        """A finite number; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._wrong(name, "a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self._wrong(name, "a finite number")
        return number

    def pair(self, name: str) -> tuple[float, float] | None:
        """Two finite numbers; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise self._wrong(name, "two numbers")
        low, high = (
            Arguments(Job(self._kind, arguments={name: each})).number(name) for each in value
        )
        if low is None or high is None:
            raise self._wrong(name, "two numbers")
        return low, high

    def index(self, name: str) -> int:
        """The position of something in a list, from 0."""
        value = self._given.get(name)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**31:
            raise self._wrong(name, "a position from 0")
        return value

    def texts(self, name: str) -> tuple[str, ...] | None:
        """A list of texts; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or not all(isinstance(each, str) for each in value):
            raise self._wrong(name, "a list of texts")
        return tuple(value)

    def _wrong(self, name: str, allowed: str) -> JobError:
        return JobError(f"{name} must be {allowed}")
