"""Kernels of OpenBLAS that this processor can run.

    blas_kernels.py                 all of them, a line each
    blas_kernels.py --turn NUMBER   the one whose turn it is at this landing

OPENBLAS_CORETYPE takes the name. A kernel decides the last bits of every product, so no result may rest
on one.
"""
import argparse
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


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--turn", type=int)
    turn = parser.parse_args().turn
    if turn is None:
        print("\n".join(kernels()))
        return
    fast = [name for name in kernels() if name not in TOO_SLOW_FOR_A_TURN]
    if fast:
        print(fast[turn % len(fast)])


if __name__ == "__main__":
    main()
