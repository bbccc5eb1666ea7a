"""Norm-optimal iterative learning on the robot's own model: one concept a file.

From the bottom: `compiling` machine code; `motion`, `riccati`, `interior_point` the numerics of one
linear quadratic problem under the speed limit; `optimal_motion` its repetition along the motion;
`local_level`, `motion_fit`, `belief` what a measured iteration says of the platform; `tracking`,
`rectified` the reference from where the platform really starts; `learner` the law.
"""
