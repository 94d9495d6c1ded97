"""Plane geometry of cutter paths: open chains of lines and arcs, in closed form."""
