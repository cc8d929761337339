"""A small simulated arm, identified once: cheap enough for every test."""

import functools

import numpy as np
from planting import mixed_tree

import crosscheck
from crosscheck.identifying import OtherRecordings, Preparation, friction_terms, virtual_robot

CUTOFF = Preparation(10.0)
POSES = 20

NOISE_FLOOR = 0.01
"""Relative error of a torque with one percent of noise, of which the low-pass leaves less."""


@functools.cache
def virtual():
    """Three bodies, a branch and a slide, 10 s at 250 Hz."""
    return virtual_robot(mixed_tree(), friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0)


def columns():
    """Its 2500 rows by the names of columns, as in a file."""
    recording = virtual().fitted
    joints = range(1, recording.n_joints + 1)
    names = ["time_s", *(f"q_{k}" for k in joints), *(f"tau_{k}" for k in joints)]
    return dict(zip(names, np.column_stack([recording.t, recording.q, recording.tau]).T, strict=True))


def identified(methods=("ols", "wls", "consistent"), **options):
    arm = virtual()
    options = {
        "terms": arm.torque_model.terms,
        "preparation": CUTOFF,
        "held_out": OtherRecordings((arm.held_out,)),
        "poses": POSES,
    } | options
    return crosscheck.identify(arm.subject.model, arm.fitted, methods=methods, **options)


@functools.cache
def compared():
    """All methods but the slow ones."""
    return identified(("ols", "wls", "wls-pinocchio", "gls", "ridge", "consistent", "entropic", "graph"))


def identified_from(recording, methods):
    """From another recording, with the last quarter held out."""
    arm = virtual()
    return crosscheck.identify(
        arm.subject.model, recording, methods=methods, preparation=CUTOFF, terms=arm.torque_model.terms, poses=POSES
    )
