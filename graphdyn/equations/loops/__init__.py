"""The equations of robots with loops: redundant rows, dependent joints, reactions that are not determined."""
