"""Tables of Denavit-Hartenberg parameters as robots: TOML in, the URDF that it says out."""

from urdf.document.dh.expanding import expand_dh
from urdf.document.dh.table import CONVENTIONS, Convention, DHLink, DHRow, DHTable

__all__ = ["CONVENTIONS", "Convention", "DHLink", "DHRow", "DHTable", "expand_dh"]
