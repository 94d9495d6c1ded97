"""Files written, read back and measured, certified, and put in place all together."""
