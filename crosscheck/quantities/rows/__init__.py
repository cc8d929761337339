"""The rows of the table of quantities, by what they are about."""
