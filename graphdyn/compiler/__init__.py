"""From a recorded recursion to machine code or NumPy operations, and the arrays of a verb through it.

From a verb down: batch (arrays in and out), running (threads, compiled or not), programs (a recursion recorded for one
robot), native and interpreter (the two back ends).
"""
