"""Seeds of programs that draw: a fixed one unless another is asked for.

What is drawn with a seed is the same in every run; a moment is not, so that only programs which
look for faults, run on demand, take one.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import time
from pathlib import Path
from typing import Final

FIXED: Final = 2026

FRESH: Final = "fresh"
"""Asks for a seed that nobody has chosen; it is printed, so that a run can be repeated."""

HELP: Final = f'of all that is drawn: a number, or "{FRESH}"; default {FIXED}'


def seed_of(text: str) -> int:
    """The seed that an argument of a call states."""
    if text == FRESH:
        return random.SystemRandom().randrange(10**9)
    return int(text)


def add_seed(parser: argparse.ArgumentParser, default: int = FIXED) -> None:
    """Let a program take `--seed`."""
    parser.add_argument("--seed", type=seed_of, default=default, help=HELP)


def commit_seed() -> int:
    """The first 8 hexadecimal digits of the commit that is checked out; 0 without a repository."""
    call = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    head = subprocess.run(call, capture_output=True, text=True)
    return int(head.stdout[:8] or "0", 16)


def add_commit_seed(parser: argparse.ArgumentParser) -> None:
    """Let a program that counts random cases take `--seed`; by default the commit's."""
    parser.add_argument(
        "--seed",
        type=lambda word: int(word, 16),
        default=commit_seed(),
        help="hexadecimal; default: the first 8 digits of the commit that is checked out",
    )


def moment(source: random.Random, most: float) -> None:
    """Let a time of up to `most` seconds pass, for programs that stop others at any moment."""
    time.sleep(source.uniform(0.0, most))
