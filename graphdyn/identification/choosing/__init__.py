"""Choice of the terms of a torque model: quick robust fits of many models, and their errors on held-out folds."""

from graphdyn.identification.choosing.fold_errors import ErrorDifference, FoldErrors
from graphdyn.identification.choosing.robust_folds import FoldedFit, RobustFolds
from graphdyn.identification.choosing.term_columns import TermColumns, every_row

__all__ = [
    "FOLD_PRIOR_STRENGTH",
    "ErrorDifference",
    "FoldErrors",
    "FoldedFit",
    "RobustFolds",
    "TermColumns",
    "every_row",
]
