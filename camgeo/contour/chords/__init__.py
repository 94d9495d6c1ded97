"""Contours of straight pieces: chords between points of the curve, or fewest, on both sides."""
