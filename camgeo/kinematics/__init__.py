"""Motions, and the mechanisms that make them.

`plan` is the motion of a follower as VDI 2143 plans it, piece by piece, `laws` has the laws of the
moves, and `planning` makes a plan of what a designer asks for. `mechanism` maps the lift to the
path of the roller or of the flat face in the turning cam; linkages map a motion to another.
Everything is a function of the cam angle with known breaks; derivatives follow by the chain rule.
"""
