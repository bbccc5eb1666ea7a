"""How to cite the paper that hilc reproduces."""

BIBTEX = """\
@article{qiao2021,
  author  = {Qiao, L. and Xiao, L. and Luo, Q. and Li, M. and Jiang, J.},
  title   = {Design Hybrid Iterative Learning Controller for Directly Driving the Wheels of
             Mobile Platform against Uncertain Parameters and Initial Errors},
  journal = {Applied Sciences},
  year    = {2021},
  volume  = {11},
  pages   = {8181},
  doi     = {10.3390/app11178181},
}
"""
"""The entry of a BibTeX file; it has what the paper says of itself."""
