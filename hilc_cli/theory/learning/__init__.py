"""Whether a linear law learns, how fast, and where it comes to rest."""
