"""Effects: what a scene calls for beyond the geometry, one module or package each.

Nothing here is imported before a scene names it; `camgeo.effects.registry` is the one that does.
"""
