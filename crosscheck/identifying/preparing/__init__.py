"""Preparation of recordings for the identification: filters, fitted rows, and predicted rows."""
