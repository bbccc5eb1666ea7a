"""Results: what an iteration was, how well it tracked, and the folder that holds it all."""
