"""The command line, and the commands that have no answer."""
