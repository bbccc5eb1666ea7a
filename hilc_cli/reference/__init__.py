"""Reference trajectories: segments, and the sampled path that they make."""
