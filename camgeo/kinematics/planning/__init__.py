"""Planning: from what a designer states at a few angles to a plan whose laws join smoothly."""
