#!/usr/bin/env python3
"""Fails where codespell knows a word of a page as a common mistake. Skips (77) without codespell.

check_spelling.py ROOT
"""
import pathlib
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
from check_links import pages

MEANT = "mdoes"  # what a page shows as a mistake


def main():
    if not shutil.which("codespell"):
        print("no codespell here")
        return 77
    files = [str(page) for page in pages(pathlib.Path(sys.argv[1]).resolve())]
    done = subprocess.run(["codespell", "--quiet-level", "3", "-L", MEANT, *files], check=False)
    print(f"{len(files)} pages looked at")
    return bool(done.returncode)


if __name__ == "__main__":
    sys.exit(main())
