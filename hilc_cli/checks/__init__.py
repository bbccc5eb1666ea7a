"""What is to be expected of a scenario, told before it is run."""
