"""Diagnosis of user code: experiments on it, and faults put into graphdyn until the numbers match."""
