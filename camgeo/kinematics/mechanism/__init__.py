"""Mechanisms: linkages make a motion from a motion, followers make a curve from a motion."""
