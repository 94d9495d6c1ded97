"""Programs that draw random cases and compare camgeo with independent answers.

    python -m tests.draws.NAME [--count N] [--seed HEX] [--rows FILE]

Each prints a line for each miss, then the seed and the number of cases, and ends with 1 if there
is a miss. A few cases of each, with a fixed seed, are among the tests.
"""
