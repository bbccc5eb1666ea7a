"""Norm-optimal iterative learning on the robot's own model: one concept a file.

From the bottom: `motor` is the model, from wheel speeds sent to motion; `motion_filter` says where
a robot was and what the model did not expect, `driven` what a pass was by all its readings,
`filter_slopes` and `noise_score` how that changes with robot and noise, `passes_told` what
`kept_passes` tell together; `identification` finds the model behind them, a `belief`, with
`bounded_search`, `parameter_errors` how far it may be off,
`repeating` what comes back beyond it, `misfit` whether there is more than it knows, both by
`cosines` along the path and by what `chance` makes; `motor_motion`, `motor_quadratic`, `free_step`
and `motor_plan` find what to send under the speed limit, `linear_quadratic`, `optimal_motion` and
`rectified` the way into the trajectory from where the platform really starts, both by
`bounded_changes`;
`pose_regulator` is the feedback, `regulator_control` what that does in a pass; `safeguard` goes
back where learning made it worse; `learner` is the law at work, `law` is how it is asked for.
"""
