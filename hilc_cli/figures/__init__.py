"""Pictures of results: one kind a file, arrays in, a Matplotlib figure out."""
