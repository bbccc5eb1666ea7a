"""Learning laws, one a file, and the gain matrix that they share."""
