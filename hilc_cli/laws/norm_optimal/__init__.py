"""Norm-optimal iterative learning on the robot's own model: one concept a file.

From the bottom: `linear_quadratic` is one linear quadratic problem, `optimal_motion` solves it
under the speed limit and repeats it along the motion; `local_level`, `noise_levels`,
`identification` and `belief` are what a measured iteration says of the platform; `rectified` makes
the reference from where the platform really starts; `learner` is the law at work, `parameters` are
its numbers, `law` is how it is asked for.
"""
