"""`python -m crosscheck` is the program `graphdyn`."""

from crosscheck.cli import main

if __name__ == "__main__":
    main()
