"""The part around the flanks: bore, keyway, hub, holes, letters, chamfers, as closed boundaries.

A part is layers of boundaries, each with its material side. `printing` and its neighbours change a
part so that what a printer makes of it is the part that was meant.
"""
