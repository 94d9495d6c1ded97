"""Files written, read back and measured, certified, and moved into place together."""
