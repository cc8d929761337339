"""A rigid-body model as source code in other languages."""
