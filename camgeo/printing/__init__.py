"""Parts as they are printed: what a printer does to them, undone beforehand."""
