"""`python -m graphdyn` is the program `graphdyn`: the package crosscheck, which this one does not import."""

from importlib import import_module

if __name__ == "__main__":
    import_module("crosscheck.commands").main()
