"""Many tasks at once: in processes of this machine, or on the workers of a Dask scheduler."""

from crosscheck.distributing.dask_workers import DaskWorkers
from crosscheck.distributing.processes import LocalProcesses
from crosscheck.distributing.workers import Lost, NoWorkers, Workers

__all__ = ["DaskWorkers", "LocalProcesses", "Lost", "NoWorkers", "Workers"]
