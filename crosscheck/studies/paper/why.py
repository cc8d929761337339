"""Explanations of the experiment, the corrected section 3.2 and the errata; other modules have their own."""

EXPERIMENT = (
    "From rest the carriage accelerates at 2 m/s² along world x, joint 1 at +30°/s² about the vertical, joint 2 at "
    "-30°/s² about its e_2; joints 3 to 6 are locked. The paper's 9.5493 rad/s² is 30/π, a misprint for "
    "0.523599 rad/s² (B4)."
)

WHY_CORRECTED = (
    "Gravity and the whole motion are in B, and the two axis rows are normal to each axis: rank 30, thirty finite "
    "multipliers, equal to the joint wrenches of rnea. The printed ones differ because they are not constraint forces "
    "of the motion (C4): the moments that the paper looks for in λ_j4, λ_j5 of joints 2, 3 and 5 are the torques of "
    "their actuators, and of the moments the bearings carry only those across the axis."
)

WHY_ERRATA = (
    "Each printed error is put back alone into the correct model of two arms, at random states; Pinocchio's aba and "
    "rnea are the reference. Errors are relative to the largest entry; a single state says little, so quantiles are "
    "given."
)
