"""What the commands find, as frozen results, and their renderings."""
