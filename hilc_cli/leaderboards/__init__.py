"""Several laws on the same cases."""
