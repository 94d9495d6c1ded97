"""Effects: what a scene calls for beyond the geometry, one package each.

Nothing here is imported before a scene names it; `camgeo.effects.registry` imports the package of
an effect, which declares it, and `camgeo.effects.graph` what computes it.
"""
