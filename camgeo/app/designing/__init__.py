"""The live designer without its page: changes of a scene's text, and the data for the page."""
