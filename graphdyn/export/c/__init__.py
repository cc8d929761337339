"""Exported functions as C99: the functions on rows of numbers, headers for C and C++, and a program that tests them."""
