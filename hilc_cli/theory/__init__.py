"""What theory says of an experiment before it is simulated."""
