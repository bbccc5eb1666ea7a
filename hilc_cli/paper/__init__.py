"""The figures and claims of Qiao et al. 2021, and how each is reproduced."""
