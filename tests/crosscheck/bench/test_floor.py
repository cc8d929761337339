"""What the machine needs at least for a work: its operations, and the loop that takes as long."""

import pytest

from crosscheck.bench.machine.floor import (
    FloorLoops,
    Machine,
    floating_point_operations,
    floor,
    fused_instructions,
    limit,
    machine,
)
from graphdyn import kr500
from graphdyn.scalars.expressions import Recorder


class TestFloor:
    @pytest.mark.parametrize(
        ("operations", "instructions", "bandwidth", "loop"),
        [
            (1e10, 5.2e9, 1e12, ("mix", 24)),
            (1e10, 5e9, 1e12, ("multiply", 12)),
            (1e9, 8e9, 1e12, ("multiply", 12)),
            (1e10, 6e9, 1e9, ("copy", 2)),
        ],
    )
    def test_what_limits(self, monkeypatch, operations, instructions, bandwidth, loop):
        """The least time is that of what takes longest, and the loop does as much of it."""
        on = Machine(8, 1, operations, instructions, bandwidth)
        least = floor(kr500(), "inverse_dynamics", on)
        assert least.operations / 2 <= least.instructions < least.operations
        assert least.products < least.instructions
        needed = least.instructions / instructions, 2 * least.products / operations, least.bytes / bandwidth
        assert least.seconds == max(needed)
        done = []
        for name in ("mix", "multiply", "copy"):
            monkeypatch.setattr(FloorLoops, name, lambda self, count, name=name: done.append((name, count)))
        limit(least, on)(9600)
        ((name, count),) = done
        amount = {"mix": least.instructions, "multiply": least.products, "copy": least.bytes}[name]
        if instructions == operations / 2:
            amount = least.instructions
        assert (name, count) == (loop[0], pytest.approx(amount * 9600 / (8 * loop[1]), abs=0.5))


class TestOperations:
    def test_operations(self):
        recorder = Recorder()
        x, y = recorder.inputs("x", 2)
        program = recorder.program({"out": [x * y + 3.0, -(1.0 / x)]}, {})
        assert floating_point_operations(program) == 3
        angles = recorder.program({"out": [x.sine, x.cosine]}, {})
        one = floating_point_operations(angles)
        both = recorder.program({"out": [x.sine, x.cosine, y.cosine]}, {})
        assert floating_point_operations(both) == 2 * one > 20

    @pytest.mark.parametrize(
        ("outputs", "instructions", "products"),
        [
            (lambda x, y: [x * y + 3.0], 1, 1),
            (lambda x, y: [x * y + 3.0, x * y], 2, 1),  # the product is wanted too
            (lambda x, y: [x * y + 3.0, x * y - y], 3, 1),
            (lambda x, y: [x * x + y * y], 2, 2),  # one of both is fused
            (lambda x, y: [x + y, x / y], 2, 1),
            (lambda x, y: [x.sine], 20, 19),  # polynomials of sine and cosine, reduction of the angle
        ],
    )
    def test_instructions_after_fusion(self, outputs, instructions, products):
        recorder = Recorder()
        program = recorder.program({"out": outputs(*recorder.inputs("x", 2))}, {})
        assert fused_instructions(program) == (instructions, products)

    def test_nothing_compiled_no_floor(self, monkeypatch):
        monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")
        assert machine(1) is None
