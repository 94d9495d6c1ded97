"""Pictures of a sweep: a map over two keys, parallel axes, and the Pareto front of two answers."""
