"""What is milled: cuts, strategies, the moves of the cutter, and their simulation.

`machine` describes controllers as data; `plan` makes the moves, and `simulation` takes the blank
down by them and tells gouges, rests and what comes loose.
"""
