"""Many designs, or one looked at more closely.

`sweep` computes families and keeps them in a store, `optimise` searches them, `tolerancing`
computes machines whose dimensions deviate, `accuracy` measures what a tolerance costs and buys, and
`inspection` compares a measured disc with the exact one.
"""
