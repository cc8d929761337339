"""`python -m crosscheck` is the program `graphdyn`."""

from crosscheck.commands import main

if __name__ == "__main__":
    main()
