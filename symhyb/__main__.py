"""``python -m symhyb``: the same as the command ``symhyb``."""

from symhyb.cli.app import main

if __name__ == "__main__":
    main()
