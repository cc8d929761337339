"""Diagnosis of foreign code: experiments on it, and faults put into graphdyn until the numbers match."""
