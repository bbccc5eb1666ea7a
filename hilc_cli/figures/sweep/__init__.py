"""Pictures of sweeps: one kind a file, the results of all cases in, a Matplotlib figure out."""
