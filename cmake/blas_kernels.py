"""Kernels of OpenBLAS that this processor can run.

    blas_kernels.py                   all of them, a line each
    blas_kernels.py --turn-of TREE    the one whose turn it is at the tree's landing

OPENBLAS_CORETYPE takes the name. A kernel decides the last bits of every product, so no result may rest
on one.
"""
import argparse
import subprocess
from pathlib import Path

NEEDS = {"Prescott": {"pni"}, "Haswell": {"avx2", "fma"}, "Zen": {"avx2", "fma"},
         "SkylakeX": {"avx512f", "avx512dq", "avx512bw", "avx512vl"},
         "Cooperlake": {"avx512f", "avx512_bf16"}}
# Prescott has no fused products: tests would take half as long again.
TOO_SLOW_FOR_A_TURN = {"Prescott"}


def flags_of_processor():
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return set()
    for line in text.splitlines():
        if line.startswith("flags"):
            return set(line.split(":", 1)[1].split())
    return set()


def kernels():
    there = flags_of_processor()
    return [name for name, needs in NEEDS.items() if needs <= there]


def git(tree, *words):
    """What git says of a tree; empty where it fails."""
    done = subprocess.run(["git", "-C", tree, *words], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def turn_of(tree):
    """The turn changes with every fourth landing. A shallow clone cannot count them: its hash decides,
    as for the samples of the tests (tests/rotation/drawn_sample.cpp)."""
    commit = git(tree, "rev-parse", "HEAD")
    if not commit:
        return 0
    if git(tree, "rev-parse", "--is-shallow-repository") == "true":
        return int(commit[:8], 16) // 1000 // 4
    return int(git(tree, "rev-list", "--count", "--first-parent", "HEAD")) // 4


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--turn-of", metavar="TREE")
    tree = parser.parse_args().turn_of
    if tree is None:
        print("\n".join(kernels()))
        return
    fast = [name for name in kernels() if name not in TOO_SLOW_FOR_A_TURN]
    if fast:
        print(fast[turn_of(tree) % len(fast)])


if __name__ == "__main__":
    main()
