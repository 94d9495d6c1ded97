"""Contours: lines and arcs fitted to the exact curve within a tolerance that is proved."""
