"""What a drawing shows, as data: a sheet with views, dimensions, texts and tables."""
