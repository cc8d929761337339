"""Recursions written once, run on NumPy arrays or compiled for the robot at hand. Nothing in this package is public.

From a verb down: batch (arrays in and out), running (threads, compiled or not), programs (a recursion recorded for one
robot), recursions (the table of them), native and interpreter (the two back ends).
"""
