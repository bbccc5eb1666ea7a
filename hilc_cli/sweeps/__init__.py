"""Many experiments: chunks of cases, who computes them, and what is kept of them."""
