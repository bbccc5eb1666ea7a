"""What a scenario says, as models, and the experiment that follows from it."""
