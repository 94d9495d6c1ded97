"""What is drawn, as data: figures of a design, and the sheet of a technical drawing.

Nothing here draws. Renderers take figures, and the writer of drawings takes sheets.
"""
