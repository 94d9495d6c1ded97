"""What all programs that draw have in common: their words, their rows and what they print."""

from __future__ import annotations

import argparse
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from tests.seeds import add_commit_seed

Case = tuple[str, Sequence[str]]
"""What a case is, in a line, and its misses."""


def parser_of(doc: str | None, count: int) -> ArgumentParser:
    """What is read from the command line: `--count`, which is `count` by default, seed and rows."""
    parser = ArgumentParser(description=doc, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=count, help=f"of cases; default: {count}")
    parser.add_argument("--rows", type=Path, help="file for a line for each case")
    add_commit_seed(parser)
    return parser


def run_cases(parser: ArgumentParser, draw: Callable[[Namespace], Iterable[Case]]) -> int:
    """Judge the cases that are drawn as the command line says; 1 if there is a miss."""
    asked = parser.parse_args()
    rows: list[str] = []
    bad = 0
    for name, misses in draw(asked):
        rows.append("\t".join((name, *misses)))
        bad += bool(misses)
        for miss in misses:
            sys.stdout.write(f"{name}: {miss}\n")
            sys.stdout.flush()
    if asked.rows is not None:
        asked.rows.write_text("".join(f"{row}\n" for row in rows), "utf-8")
    sys.stdout.write(f"seed {asked.seed:08x}: {len(rows)} cases, {bad} missed\n")
    return int(bad > 0)
