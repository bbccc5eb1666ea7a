"""Learning on a real robot: plans out, logs in, and the folder that remembers them."""
