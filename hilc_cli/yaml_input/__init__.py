"""What people write: YAML with positions, expressions, the models that validate it."""
