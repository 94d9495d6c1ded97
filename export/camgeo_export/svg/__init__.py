"""SVG at true size, for laser cutters and drawing programs."""
