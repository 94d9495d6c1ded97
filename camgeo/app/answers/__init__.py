"""Commands with an answer: their options, their frozen results, and the renderings of these."""
