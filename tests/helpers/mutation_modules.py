"""The modules in which mutation_run.py plants faults, and the changes that make no difference."""

_STATISTICS = "tests/graphdyn/identification/statistics/test_statistics.py"

MODULES = {
    "crosscheck/recordings/mapping/units.py": "tests/crosscheck/recordings/mapping/test_mapping.py",
    "crosscheck/quantities/scales.py": "tests/crosscheck/quantities/test_scales.py",
    "crosscheck/report/plain_text.py": "tests/crosscheck/report/test_shown_numbers.py",
    "graphdyn/identification/statistics/correlation.py": _STATISTICS,
    "urdf/reading/checks.py": "tests/urdf/reading/test_thresholds.py tests/urdf/reading/test_checks.py",
}
"""The tests of each."""

_SQUARE = "the matrices are square"
_SYMMETRIC = "the inverse of a symmetric matrix is symmetric"
_INVERSE_NORM = "inverse_norm = np.abs(np.linalg.inv(mass)).sum(axis=-1).max(axis=-1)"
_UNIT_MATRIX = "mass = np.where(finite[:, None, None], mass, np.eye(mass.shape[-1]))"

EQUIVALENT: dict[str, dict[tuple[str, str], str]] = {
    "crosscheck/report/plain_text.py": {
        (
            'return f"{ratio:.3g}×" if ratio < 999.5 else f"{ratio:.0f}×"',
            'return f"{ratio:.3g}×" if ratio < 998.5 else f"{ratio:.0f}×"',
        ): "between these, both forms have three digits and no exponent",
        (
            'return f"{ratio:.3g}×" if ratio < 999.5 else f"{ratio:.0f}×"',
            'return f"{ratio:.3g}×" if ratio <= 999.5 else f"{ratio:.0f}×"',
        ): "999.5 itself is printed as 1e+03 or as 1000, which no measured ratio is",
    },
    "crosscheck/quantities/scales.py": {
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[+1]")): _SQUARE,
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[~1]")): _SQUARE,
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[1]")): _SQUARE,
        (_UNIT_MATRIX, _UNIT_MATRIX.replace("[-1]", "[- 2]")): _SQUARE,
        (_INVERSE_NORM, _INVERSE_NORM.replace("sum(axis=-1)", "sum(axis=+1)")): _SYMMETRIC,
        (_INVERSE_NORM, _INVERSE_NORM.replace("sum(axis=-1)", "sum(axis=~1)")): _SYMMETRIC,
        (_INVERSE_NORM, _INVERSE_NORM.replace("max(axis=-1)", "max(axis=+1)")): "the last axis is the second one",
        (
            "sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=-1)",
            "sizes: Array = np.abs(x).reshape(len(x), - 2).max(axis=-1)",
        ): "NumPy takes any negative length as the one that is left",
        (
            "sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=-1)",
            "sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=+1)",
        ): "the last axis is the second one",
        (
            "@dataclass(frozen=True, eq=False)",
            "@dataclass(frozen=False, eq=False)",
        ): "nothing assigns to it",
        (
            "@dataclass(frozen=True, eq=False)",
            "@dataclass(frozen=True, eq=True)",
        ): "nothing compares it",
    },
}
"""Changes that no test can notice, by module: the line before and after, and why."""
