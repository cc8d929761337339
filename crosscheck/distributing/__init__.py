"""Many tasks at once: in processes of this machine, or on the workers of a Dask scheduler."""

from crosscheck.distributing.dask_workers import DaskWorkers
from crosscheck.distributing.processes import LocalProcesses
from crosscheck.distributing.workers import MISSING, Lost, NoWorkers, Workers, differences, versions

__all__ = ["MISSING", "DaskWorkers", "LocalProcesses", "Lost", "NoWorkers", "Workers", "differences", "versions"]
