#!/usr/bin/env python3
"""Fails when a public header does not compile on its own.

check_headers.py ROOT COMPILER FLAGS...
A header that names a heavy library belongs to a door (check_layers.py) and is nobody else's.
Each takes a second: every third is looked at, unless CHLADNI_STUDIES=all.
"""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
from check_layers import DOORS, INCLUDE, MAY_INCLUDE


def is_public(header, root):
    """Whether neither the header nor one of ours that it includes names a heavy library."""
    for line in header.read_text().splitlines():
        if not (m := INCLUDE.match(line)):
            continue
        if any(re.match(library, m[1]) for library in DOORS):
            return False
        ours = root / m[1]
        if ours.is_file() and not is_public(ours, root):
            return False
    return True


def fault_of(header, root, compiler):
    source = f'#include "{header.relative_to(root)}"\n'
    done = subprocess.run(
        [*compiler, "-fsyntax-only", f"-I{root}", "-x", "c++", "-"],
        input=source, capture_output=True, text=True, check=False,
    )
    return f"{header.relative_to(root)}:\n{done.stderr}" if done.returncode else None


def main():
    root, compiler = pathlib.Path(sys.argv[1]), sys.argv[2:]
    headers = [h for room in MAY_INCLUDE for h in sorted(root.glob(f"{room}/**/*.h")) if is_public(h, root)]
    if os.environ.get("CHLADNI_STUDIES") != "all":
        headers = headers[::3]
    cores = len(os.sched_getaffinity(0))
    with concurrent.futures.ThreadPoolExecutor(cores) as pool:
        faults = [f for f in pool.map(lambda h: fault_of(h, root, compiler), headers) if f]
    print("\n".join(faults) or f"{len(headers)} headers compile alone")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
