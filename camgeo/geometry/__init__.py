"""Plane curves of a cam: exact ones, and those that files can hold.

`pitch_curve` and `working_curve` are the exact curves over the cam angle; `outline` is what remains
of a flank after the roller, as a cutter, has passed all of it; `contour` has the lines, arcs and
cubics within a tolerance of it, each with the proof of its deviation.
"""
