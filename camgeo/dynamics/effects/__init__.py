"""Effects: what a scene requests beyond the geometry, one module each.

Nothing here is imported before a scene names it: `camgeo.dynamics.effects.registry` declares all
effects, and `camgeo.dynamics.effects.graph` imports the module that computes one.
"""
