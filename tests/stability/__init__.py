"""Numerical stability: results of camgeo in doubles compared with references of eighty digits."""

from __future__ import annotations
