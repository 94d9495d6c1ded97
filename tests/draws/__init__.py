"""Programs that draw random cases and compare camgeo with independent answers.

    python -m tests.draws.NAME [--count N] [--seed HEX] [--rows FILE]

Each prints the seed, the number of cases and one line for each miss, and ends with 1 if there is
one. A few cases of each, with a fixed seed, are among the tests.
"""
