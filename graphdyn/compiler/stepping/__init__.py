"""Whole simulations in compiled code, one robot per lane."""
