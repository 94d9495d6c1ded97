"""Smaller cases that fail in the same way."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from tests.fuzz.case import SCENE, Case, changed, paths, value_at
from tests.fuzz.drawn import set_span, span_of

Fails = Callable[[Case], bool]


def minimised(case: Case, fails: Fails, tries: int = 1000) -> Case:
    """The smallest case found with so many runs by leaving out steps, files, keys and lines."""
    smaller_still = True
    while smaller_still:
        smaller_still = False
        for smaller in candidates(case):
            if _size(smaller) >= _size(case):
                continue
            if tries == 0:
                return case
            tries -= 1
            if fails(smaller):
                case, smaller_still = smaller, True
                break
    return case


def _size(case: Case) -> tuple[int, int]:
    return sum(map(len, case.steps)), sum(
        len(name) + len(data) for name, data in case.files.items()
    )


def candidates(case: Case) -> Iterator[Case]:
    """Cases with one thing less, the largest things first."""
    for k in range(len(case.steps)):
        if len(case.steps) > 1:
            yield replace(case, steps=case.steps[:k] + case.steps[k + 1 :])
    for name in case.files:
        yield replace(case, files={key: data for key, data in case.files.items() if key != name})
    values = case.values
    if values is not None:
        yield from (case.with_values(each) for each in smaller_scenes(values))
    for name, data in case.files.items():
        if name != SCENE or values is None:
            yield from (case.with_file(name, each) for each in shorter(data))
    for k, step in enumerate(case.steps):
        for word in range(1, len(step)):
            less = step[:word] + step[word + 1 :]
            yield replace(case, steps=(*case.steps[:k], less, *case.steps[k + 1 :]))


def smaller_scenes(values: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Scenes without one key or segment, or with a shorter number."""
    motion = values.get("motion")
    if isinstance(motion, list):
        for k in range(len(motion)):
            yield from _without_segment(values, k)
    known = sorted(paths(values), key=len)
    for path in known:
        yield changed(values, path, None)
    for path in known:
        number = value_at(values, path)
        if isinstance(number, float):
            for digits in (1, 2, 3, 6):
                yield changed(values, path, float(f"{number:.{digits}g}"))


def _without_segment(values: dict[str, Any], k: int) -> Iterator[dict[str, Any]]:
    """Without a segment, whose span the one before or after it takes over, or none."""
    for other in (k - 1, k + 1, None):
        found = copy.deepcopy(values)
        motion = found["motion"]
        if other is not None:
            if not 0 <= other < len(motion):
                continue
            if not all(isinstance(motion[i], dict) for i in (k, other)):
                continue
            spans = span_of(motion[k]), span_of(motion[other])
            if spans[0] is None or spans[1] is None:
                continue
            set_span(motion[other], round(spans[0] + spans[1], 9))
        del motion[k]
        yield found


def shorter(data: bytes) -> Iterator[bytes]:
    """Without a half, a quarter, ... of the lines, or of the bytes where there are few lines."""
    parts = data.splitlines(keepends=True)
    if len(parts) < 2:
        parts = [data[k : k + 1] for k in range(len(data))]
    size = len(parts)
    while size > max(len(parts) // 64, 0):
        for start in range(0, len(parts), size):
            yield b"".join(parts[:start] + parts[start + size :])
        size //= 2
        if size == 0:
            return
