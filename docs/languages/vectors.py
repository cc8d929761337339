"""Compares a function with a file of test vectors, whose decimals may have any number of digits. To run it:

graphdyn vectors ur5 --digits 30 --out vectors
graphdyn export ur5 --to model.h
cc -O2 -fPIC -shared -o librnea.so rnea.c -lm
python vectors.py
"""

import csv
import ctypes
import sys
from fractions import Fraction


def failures(path, arguments, numbers, function):
    """How many rows have a number beyond its tolerance, and the largest error; nothing is rounded here."""
    failed, largest = 0, Fraction(0)
    with open(path, encoding="ascii") as file:
        _, *rows = csv.reader(file)
    for row in rows:
        answers = function([float(x) for x in row[:arguments]])
        exact, tolerances = row[arguments : arguments + numbers], row[arguments + numbers :]
        errors = [abs(Fraction(x) - Fraction(y)) for x, y in zip(answers, exact, strict=True)]
        failed += any(error > Fraction(most) for error, most in zip(errors, tolerances, strict=True))
        largest = max(largest, *errors)
    return failed, float(largest)


library = ctypes.CDLL("./librnea.so")


def rnea(x):
    values = (ctypes.c_double * 18)(*x)
    q, v, a = ((ctypes.c_double * 6).from_buffer(values, 48 * k) for k in range(3))
    tau = (ctypes.c_double * 6)()
    library.rnea(6, q, v, a, tau)
    return list(tau)


failed, largest = failures("vectors/inverse_dynamics_exact.csv", 18, 6, rnea)
print(f"inverse_dynamics: {failed} rows fail, errors up to {largest:.2g} N m")
sys.exit(failed != 0)
