"""Norm-optimal iterative learning on the robot's own model: one concept a file.

From the bottom: `motion` is the model's motion; `riccati`, `linear_quadratic` and `interior_point`
solve one linear quadratic problem under the speed limit, `optimal_motion` repeats it along the
motion; `local_level`, `motion_fit`, `belief` and `unexplained` are what a measured iteration says
of the platform; `tracking` and `rectified` make the reference from where the platform really
starts; `learner` is the law.
"""
