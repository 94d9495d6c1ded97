"""What is milled: cuts, strategies, the moves of the cutter, and their simulation.

`machine` describes controllers as data; `plan` makes the moves, and `simulation` removes what they
sweep from the blank and reports gouges, material that is left, and pieces that come loose.
"""
