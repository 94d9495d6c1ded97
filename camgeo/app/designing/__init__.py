"""What the live designer does with a scene: changes of its text, and what can be changed in it."""
