"""Norm-optimal iterative learning on the robot's own model: one concept a file.

From the bottom: `motor` is the model, from wheel speeds sent to motion; `motion_filter` says where
a robot was and what the model did not expect; `identification` finds the model behind passes,
`repeating` what comes back beyond it, `misfit` whether there is more than it knows;
`motor_quadratic` and `motor_plan` find what to send under the speed limit, `linear_quadratic`,
`optimal_motion` and `rectified` the way into the trajectory from where the platform really starts;
`pose_regulator` is the feedback; `safeguard` goes back where learning made it worse; `learner` is
the law at work, `law` is how it is asked for.
"""
