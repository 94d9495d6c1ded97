"""Many designs, or one looked at more closely.

`sweep` computes families and keeps them in a store, `optimise` searches them, `tolerancing` has the
machine deviate, `accuracy` measures what a tolerance costs and buys, `inspection` compares a
measured disc with the exact one.
"""
