#!/usr/bin/env python3
"""Fails when a public header does not compile on its own.

check_headers.py ROOT SAMPLE COMPILER FLAGS...
A header that names a heavy library belongs to a door (check_layers.py) and is nobody else's.
What the last commit changed is looked at, and every eighth of the others: eight landings in a row look at
all (tests/rotation). The program SAMPLE prints from which one on, or "all". What includes Eigen/Core,
itself or by ours, gets it precompiled.
"""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
from check_layers import DOORS, INCLUDE, MAY_INCLUDE


def includes(header, root, seen=None):
    """What the header includes, itself and by ours."""
    seen = set() if seen is None else seen
    for line in header.read_text().splitlines():
        if not (m := INCLUDE.match(line)) or m[1] in seen:
            continue
        seen.add(m[1])
        if (ours := root / m[1]).is_file():
            includes(ours, root, seen)
    return seen


def is_public(header, root):
    """Whether neither the header nor one of ours that it includes names a heavy library."""
    return not any(re.match(library, name) for name in includes(header, root) for library in DOORS)


def precompiled(folder, compiler):
    """A header in the folder that stands for Eigen/Core."""
    header = pathlib.Path(folder) / "core.h"
    header.write_text("#include <Eigen/Core>\n")
    subprocess.run([*compiler, "-x", "c++-header", header, "-o", f"{header}.gch"], check=True)
    return header


def fault_of(header, root, compiler, core):
    source = f'#include "{header.relative_to(root)}"\n'
    before = ["-include", core] if "Eigen/Core" in includes(header, root) else []
    done = subprocess.run(
        [*compiler, "-fsyntax-only", f"-I{root}", *before, "-x", "c++", "-"],
        input=source, capture_output=True, text=True, check=False,
    )
    return f"{header.relative_to(root)}:\n{done.stderr}" if done.returncode else None


def changed(root):
    """The files that differ from the first parent, as git knows them; nothing where it does not."""
    done = subprocess.run(["git", "-C", root, "diff", "--name-only", "HEAD^1"],
                          capture_output=True, text=True, check=False)
    return set(done.stdout.split())


def main():
    root, sample, compiler = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]
    headers = [h for room in MAY_INCLUDE for h in sorted(root.glob(f"{room}/**/*.h")) if is_public(h, root)]
    number = subprocess.run([sample, root], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    if number != "all":
        touched = changed(root)
        headers = [h for place, h in enumerate(headers)
                   if place % 8 == int(number) % 8 or str(h.relative_to(root)) in touched]
    cores = len(os.sched_getaffinity(0))
    with (tempfile.TemporaryDirectory() as folder,
          concurrent.futures.ThreadPoolExecutor(cores) as pool):
        core = precompiled(folder, compiler)
        faults = [f for f in pool.map(lambda h: fault_of(h, root, compiler, core), headers) if f]
    print("\n".join(faults) or f"{len(headers)} headers compile alone")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
