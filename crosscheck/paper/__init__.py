"""The paper beside the corrected model: its tables, its multipliers, its errata."""
