"""Slips planted in texts of recursions that were written for these tests alone: at one joint, or at every joint."""

from dataclasses import dataclass

import numpy as np
from faults.textbook import TextbookArm, cross
from scipy.spatial.transform import Rotation
from slips import lagrange, link_frames, spatial_vectors, world_frames

FORMS = {"link": link_frames, "world": world_frames, "spatial": spatial_vectors, "Lagrange": lagrange}


def hat(x):
    """The matrix of x ×."""
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def crm(m):
    """The matrix of the product with motions."""
    found = np.zeros((6, 6))
    found[:3, :3] = found[3:, 3:] = hat(m[:3])
    found[3:, :3] = hat(m[3:])
    return found


def crf(m):
    """The matrix of the product with forces."""
    return -crm(m).T


class QuickNumPy:
    """NumPy whose cross product is of two vectors, which takes a tenth of the time."""

    cross = staticmethod(cross)

    def __getattr__(self, name):
        return getattr(np, name)


@dataclass(frozen=True)
class PlantedSlip:
    """What stands in one place of a text. named: an expression that the message must match"""

    form: str
    place: str
    instead: str
    named: str

    def __str__(self):
        return f"{self.form}: {self.place.strip()} → {self.instead.strip()}"

    def function(self, model, joint=None):
        """The code with the slip, as inverse dynamics. joint: number of the only one where it is wrong"""
        return compiled(FORMS[self.form].TEXT, self, model, range(model.n_bodies) if joint is None else [joint])


PLANTED_SLIPS = [PlantedSlip(form, *slip) for form, module in FORMS.items() for slip in module.SLIPS]


def right_function(form, model):
    """The code without a slip."""
    return compiled(FORMS[form].TEXT, None, model, ())


def compiled(text, slip, model, joints):
    """The function of a text, wrong at some joints."""
    if slip is not None:
        assert text.count(slip.place) == 1, slip
        start = text.rfind("\n", 0, text.index(slip.place)) + 1
        right = text[start:].split("\n")[0]
        place, instead = (x.split("\n")[0] for x in (slip.place, slip.instead))
        wrong = right.replace(place, instead)
        assert right.count(place) == 1, slip
        indent = right[: len(right) - len(right.lstrip())]
        choice = f"{indent}if j in BAD:\n    {wrong}\n{indent}else:\n    {right}"
        text = text[:start] + choice + text[start + len(right) :]
    names = {"np": QuickNumPy(), "Rotation": Rotation, "hat": hat, "crm": crm, "crf": crf, "O3": np.zeros((3, 3))}
    exec(text, names)
    arm, bad = TextbookArm.of(model), frozenset(joints)
    return lambda q, v, a: names["inverse_dynamics"](arm, q, v, a, bad)
