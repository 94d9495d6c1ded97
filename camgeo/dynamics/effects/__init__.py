"""Effects: what a scene requests beyond the geometry, one package each.

Nothing here is imported before a scene names it: `camgeo.dynamics.effects.registry` imports the
package that declares an effect, and `camgeo.dynamics.effects.graph` the module that computes it.
"""
