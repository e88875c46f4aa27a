"""python -m chladni VERB ...: the program of the command line."""
import os
import sys

from . import _chladni


def main():
    """Becomes the program, with the arguments of this one."""
    program = _chladni._program()
    os.execv(program, [program, *sys.argv[1:]])


if __name__ == "__main__":
    main()
