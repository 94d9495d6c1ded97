"""What `camgeo machines` finds, in words."""

from __future__ import annotations

from collections.abc import Sequence

from camgeo.answers.machines import Key, Listed, Machines

WORDS = {
    "manual": "manual", "source code": "source code", "interpreter": "interpreter",
    "machine": "machine", "post": "post", "none": "not confirmed",
}  # fmt: skip
"""Of the kinds of evidence."""


def text(answer: Machines) -> str:
    """One line per profile, or the keys of one with what they rest on."""
    if answer.listed is not None:
        return "\n".join(_list(answer.listed))
    assert answer.shown is not None
    shown, machine = answer.shown, answer.shown.machine
    lines = [f"{shown.profile}: {machine.controller}", ""]
    lines += _keys(answer.keys or ())
    if machine.evidence:
        lines += ["", "what it rests on"]
    for each in machine.evidence:
        lines.append(f"  {WORDS[each.kind]}: {', '.join(each.about)}")
        lines.append(f"    {each.text}")
        lines += [f"    {each.source}"] if each.source else []
    return "\n".join(lines)


def evidence_line(listed: Listed) -> str:
    """How many statements rest on what."""
    return ", ".join(f"{count} {WORDS[kind]}" for kind, count in listed.evidence.items())


def _list(listed: Sequence[Listed]) -> list[str]:
    rows = [
        (each.profile, each.machine.extension, each.machine.controller, evidence_line(each))
        for each in listed
    ]
    widths = [max(len(row[column]) for row in rows) + 2 for column in range(3)]
    return [
        "".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=False)) + row[-1]
        for row in rows
    ]


def _keys(keys: Sequence[Key]) -> list[str]:
    width = max(len(each.key) for each in keys)
    return [
        f"{each.key:{width}} = {each.value}{f' {each.unit}' if each.unit else ''}" for each in keys
    ]
