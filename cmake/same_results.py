#!/usr/bin/env python3
"""Whether two builds of the program give the same results.

    same_results.py OLD NEW STUDY.toml... [--within 1e-9] [--allow-outside DIR]

Each study is run by both (`study --quiet --no-pictures --reproducible`). Their JSON files must have the same
keys and texts, and numbers that differ by less than `within` of the largest number beside them. What
names the program or a commit is left out. The exit code is the number of studies that differ.
"""
import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

LEFT_OUT = {"chladni", "version", "commit", "seconds", "cpu_seconds", "peak_memory_mb"}


def results(program, study, allowed, out):
    command = [program, "study", study, "-o", out, "--quiet", "--no-pictures", "--reproducible"]
    for folder in allowed:
        command += ["--allow-outside", folder]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          check=False)
    files = {f.name: json.loads(f.read_text(encoding="utf-8")) for f in Path(out).glob("*.json")}
    return done.returncode, files


def scale_of(*values):
    """The largest number of two lists of numbers, or of two numbers."""
    flat = [x for v in values for x in (v if isinstance(v, list) else [v])]
    return max((abs(x) for x in flat if isinstance(x, (int, float)) and math.isfinite(x)), default=0.0)


def differences(old, new, where, within, scale=0.0):
    if isinstance(old, bool) or isinstance(new, bool) or isinstance(old, str) or old is None:
        if old != new:
            yield f"{where}: {old!r} became {new!r}"
    elif isinstance(old, (int, float)) and isinstance(new, (int, float)):
        if abs(old - new) > within * max(scale, abs(old), abs(new)):
            yield f"{where}: {old!r} became {new!r}"
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        beside = scale_of(old, new)
        for i, (a, b) in enumerate(zip(old, new)):
            yield from differences(a, b, f"{where}[{i}]", within, beside)
    elif isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        for key in old.keys() - LEFT_OUT:
            yield from differences(old[key], new[key], f"{where}.{key}", within)
    else:
        yield f"{where}: {str(old)[:80]} became {str(new)[:80]}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("studies", nargs="+")
    parser.add_argument("--within", type=float, default=1e-9)
    parser.add_argument("--allow-outside", action="append", default=[])
    given = parser.parse_args()
    differ = 0
    for study in given.studies:
        with tempfile.TemporaryDirectory() as work:
            old = results(given.old, study, given.allow_outside, f"{work}/old")
            new = results(given.new, study, given.allow_outside, f"{work}/new")
        found = [f"exit {old[0]} became {new[0]}"] if old[0] != new[0] else []
        found += differences(old[1], new[1], "", given.within)
        differ += bool(found)
        print(f"{study}: exit {new[0]}, {len(new[1])} files, "
              f"{'same' if not found else f'{len(found)} differences'}", flush=True)
        for line in found[:10]:
            print("  ", line)
    return differ


if __name__ == "__main__":
    sys.exit(main())
