#!/usr/bin/env python3
"""Small faults put into the code by hand, and whether the tests see them.

mutants.py SOURCE --list             the mutants of mutants.toml
mutants.py SOURCE --check            fails where a mutant's place is not there exactly once
mutants.py SOURCE --run [N ...]      builds the one test program of each (preset release) and runs it

A mutant that its tests do not see survives: then a law is missing. Tests that fail on the sound code
see nothing. Files are put back in any case.
No part of CI but for --check; a mutant takes as long as its file and its program take to build.
"""
import argparse
import pathlib
import re
import signal
import subprocess
import sys
import tomllib


def mutants_of(source):
    text = (source / "tests/mutants/mutants.toml").read_text()
    return tomllib.loads(text)["mutant"]


def programs_of(source):
    """Names of the programs of tests of a release that is configured; empty: none is."""
    plan = source / "build/release/build.ninja"
    return set(re.findall(r"^build (\w+_test): phony", plan.read_text(), re.M)) if plan.exists() else set()


def faults_of(source, mutants):
    programs = programs_of(source)
    for number, mutant in enumerate(mutants, 1):
        file = source / mutant["file"]
        count = file.read_text().count(mutant["old"]) if file.exists() else 0
        if count != 1:
            yield f"mutant {number}: {mutant['file']} has {count} times: {mutant['old']}"
        if mutant["old"] == mutant["new"]:
            yield f"mutant {number} changes nothing"
        if programs and pathlib.Path(mutant["program"]).name not in programs:
            yield f"mutant {number}: no program {mutant['program']}"


def built(source, program):
    return subprocess.run(["cmake", "--build", "--preset", "release", "--target", program, "-j", "1"],
                          cwd=source, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)


def failed_tests(source, mutant):
    """Names of the tests that fail; what is not a test is in brackets. None if all pass."""
    run = subprocess.run([source / "build/release" / mutant["program"], "--gtest_brief=1",
                          "--gtest_filter=" + mutant.get("tests", "*")],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600,
                         check=False)
    failed = [line.split()[3].rstrip(",") for line in run.stdout.splitlines()
              if line.startswith("[  FAILED  ]") and "listed below" not in line]
    if run.returncode != 0 and not failed:
        return [f"(the end of its process, {run.returncode})"]
    return failed


def failing_before(source, mutant, known={}):
    """Why the sound code cannot judge a mutant, or nothing. Each program is asked once."""
    asked = (mutant["program"], mutant.get("tests", "*"))
    if asked not in known:
        made = built(source, mutant["program"])
        known[asked] = ("not built: " + made.stdout[-300:] if made.returncode != 0 else
                        ", ".join(failed_tests(source, mutant)))
    return known[asked]


def fate_of(source, mutant):
    """"killed by TEST", "survived", or why it could not be tried."""
    before = failing_before(source, mutant)
    if before:
        return "not tried, the sound code fails: " + before
    program = mutant["program"]
    file = source / mutant["file"]
    sound = file.read_text()
    try:
        file.write_text(sound.replace(mutant["old"], mutant["new"]))
        made = built(source, program)
        if made.returncode != 0:
            return "not built: " + made.stdout[-300:]
        failed = failed_tests(source, mutant)
    except subprocess.TimeoutExpired:
        return "killed: it does not end"
    finally:
        file.write_text(sound)
    return "killed by " + failed[0] if failed else "survived"


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # files are put back
    signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where this runs behind a shell
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--run", nargs="*", type=int)
    asked = parser.parse_args()
    source = asked.source.resolve()
    mutants = mutants_of(source)
    if asked.list:
        for number, mutant in enumerate(mutants, 1):
            print(f"{number:3}  {mutant['file']}: {mutant['old']}  ->  {mutant['new']}")
    faults = list(faults_of(source, mutants))
    print("\n".join(faults) or f"{len(mutants)} mutants have their place")
    if faults or asked.run is None:
        return bool(faults)
    fates = {}
    for number in asked.run or range(1, len(mutants) + 1):
        fates[number] = fate_of(source, mutants[number - 1])
        print(f"{number:3}  {mutants[number - 1]['file']}: {fates[number]}", flush=True)
    for program in sorted({mutants[number - 1]["program"] for number in fates}):
        built(source, program)  # as it was
    lived = [number for number, fate in fates.items() if not fate.startswith("killed")]
    print(f"{len(fates) - len(lived)} of {len(fates)} killed")
    return bool(lived)


if __name__ == "__main__":
    sys.exit(main())
