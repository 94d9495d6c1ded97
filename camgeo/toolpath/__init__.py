"""Toolpaths: exact cutter paths, leads, depth passes; moves that a G-code writer prints."""
