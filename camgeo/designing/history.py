"""The texts that a scene has had, for undo and redo: the present one and the steps between them.

A step keeps what it replaces, not the whole text, so a long scene can have as many steps as a short
one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Self

MOST_STEPS: Final = 1000
"""Most steps that can be undone."""

MOST_CHARACTERS: Final = 16_000_000
"""Most characters, in all, that these steps replace and put in their place."""

Splice = tuple[int, str, str]
"""Where two texts differ: the first character, what the first text has there, and the second."""


@dataclass(frozen=True, slots=True)
class Step:
    """What one step changed.

    Attributes
    ----------
    label : its name, e.g. ``roller radius 8 mm``.
    at : character from which on the texts differ.
    before, after : what they have there.
    gesture : changes of the same gesture, a drag say, are one step; empty for a step by itself.
    """

    label: str
    at: int
    before: str
    after: str
    gesture: str = ""

    def __len__(self) -> int:
        return len(self.before) + len(self.after)


@dataclass(frozen=True, slots=True)
class History:
    """A text with the steps that led to it, and those that were undone.

    Attributes
    ----------
    text : the present one.
    past : steps to be undone, the latest last.
    future : steps to be redone, the next last.
    """

    text: str
    past: tuple[Step, ...] = ()
    future: tuple[Step, ...] = ()

    @property
    def undo(self) -> str | None:
        """The label of what can be undone; None if there is nothing."""
        return self.past[-1].label if self.past else None

    @property
    def redo(self) -> str | None:
        """The label of what can be redone; None if there is nothing."""
        return self.future[-1].label if self.future else None

    def changed(self, text: str, label: str, gesture: str = "") -> Self:
        """With a new text and nothing left to redo.

        A change with the gesture of the latest step becomes part of that step. If the text is
        then what it was before the gesture, the step disappears.
        """
        past = self.past
        before = self.text
        if gesture and past and past[-1].gesture == gesture:
            before = spliced(before, past[-1].at, past[-1].after, past[-1].before)
            past = past[:-1]
        if before != text:
            past = (*past, Step(label, *splice(before, text), gesture))
        return replace(self, text=text, past=_bounded(past), future=())

    def undone(self) -> Self:
        """One step back; the same if there is none."""
        if not self.past:
            return self
        *past, step = self.past
        text = spliced(self.text, step.at, step.after, step.before)
        return replace(self, text=text, past=tuple(past), future=(*self.future, _ended(step)))

    def redone(self) -> Self:
        """One step forth; the same if there is none."""
        if not self.future:
            return self
        *future, step = self.future
        text = spliced(self.text, step.at, step.before, step.after)
        return replace(self, text=text, past=(*self.past, step), future=tuple(future))


def splice(before: str, after: str) -> Splice:
    """Where `before` and `after` differ: what is equal at both ends is left out."""
    head = _alike(before, after)
    before, after = before[head:], after[head:]
    tail = _alike(before[::-1], after[::-1])
    return head, before[: len(before) - tail], after[: len(after) - tail]


def _alike(one: str, other: str) -> int:
    """How many characters two texts have in common at the start; by bisection, comparing slices."""
    low, high = 0, min(len(one), len(other))
    while low < high:
        middle = (low + high + 1) // 2
        if one[low:middle] == other[low:middle]:
            low = middle
        else:
            high = middle - 1
    return low


def spliced(text: str, at: int, before: str, after: str) -> str:
    """The text with `after` in place of `before`; ValueError if `before` is not there."""
    if text[at : at + len(before)] != before:
        raise ValueError("a step does not fit the text")
    return f"{text[:at]}{after}{text[at + len(before) :]}"


def _ended(step: Step) -> Step:
    """The step with its gesture over: nothing becomes part of it after it has been undone."""
    return replace(step, gesture="")


def _bounded(past: tuple[Step, ...]) -> tuple[Step, ...]:
    """The latest steps that are within the limits; the last one always is."""
    past = past[-MOST_STEPS:]
    size = sum(map(len, past))
    first = 0
    while size > MOST_CHARACTERS and first < len(past) - 1:
        size -= len(past[first])
        first += 1
    return past[first:]
