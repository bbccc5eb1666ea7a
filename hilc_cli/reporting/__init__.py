"""How results are told on a terminal."""
