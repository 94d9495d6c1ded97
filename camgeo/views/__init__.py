"""A disc as each of its readers sees it: drawn, milled, tabulated, pictured."""
