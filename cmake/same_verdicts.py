"""Whether a study's diagnosis is the same under every BLAS kernel and number of threads.

    same_verdicts.py CHLADNI STUDY.toml... [--kernels Haswell,Zen,...] [--threads 1,2] [--allow-outside DIR]

prints for every run the verdict and its named causes. A run agrees with the first where both name the
same causes, or where both say that they are not sure: what is not named need not be the same. The exit
code is the number of studies that do not agree, 255 at most. Kernels that this processor lacks are left
out aloud.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from blas_kernels import NEEDS, kernels as kernels_of_processor


def told_causes(told):
    """The causes of a diagnosis as sorted (effect, channels, probability)."""
    return sorted((cause["effect"], tuple(cause["channels"]), round(cause["probability"], 3))
                  for cause in told["causes"])


def diagnosed(chladni, study, kernel, threads, more):
    """The verdict, and its causes."""
    with tempfile.TemporaryDirectory() as out:
        done = subprocess.run(
            [chladni, "diagnose", study, "-o", out, "--quiet", "--no-pictures",
             "--threads", str(threads), *more],
            # Kept modes would be those of the first kernel.
            env={**os.environ, "OPENBLAS_CORETYPE": kernel, "CHLADNI_CACHE": "off"},
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode not in (0, 4):
            sys.exit(f"{study}, {kernel}, {threads} threads: exit {done.returncode}: {done.stderr}")
        told = json.loads((Path(out) / "diagnosis.json").read_text(encoding="utf-8"))
    return told["verdict"], told_causes(told)


def names(run):
    verdict, causes = run
    return verdict, [cause[:2] for cause in causes] if verdict == "named" else []


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("chladni")
    parser.add_argument("study", nargs="+")
    parser.add_argument("--kernels", default=",".join(NEEDS))
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--allow-outside", dest="outside")
    told = parser.parse_args()
    more = ["--allow-outside", told.outside] if told.outside else []
    there = kernels_of_processor()
    kernels = []
    for kernel in told.kernels.split(","):
        if kernel in there:
            kernels.append(kernel)
        else:
            print(f"{kernel}: this processor lacks it")
    apart = 0
    for study in told.study:
        first = None
        agrees = True
        for kernel in kernels:
            for threads in told.threads.split(","):
                run = diagnosed(told.chladni, study, kernel, threads, more)
                first = first or run
                same = names(run) == names(first)
                agrees = agrees and same
                print(f"{study}  {kernel:10s} {threads} threads  {run[0]}  {run[1]}"
                      f"{'' if same else '  DIFFERS'}", flush=True)
        apart += not agrees
    sys.exit(min(apart, 255))


if __name__ == "__main__":
    main()
