"""Hides effects in structures that CalculiX solves, and diagnoses them with the program as it ships.

    calculix_rigs.py CHLADNI OUT [--cases a,b] [--seed N] [--lines K] [--noise X] [--solve-only | --told]

Every truth is a mesh of 20-node bricks (packages calculix-ccx, python3-scipy): its modes, and what all
above them add from one solution of its matrices. Its channels deviate by the usual tolerances, its
responses carry noise; the study is what somebody would write of the drawing: a plate, a wafer table with
pockets, an STL. Nothing of the truth's code or of its random numbers is shared with the diagnosis. Each case
leaves a folder under OUT: study.toml, measured.csv.gz, truth.json and out/diagnosis.json. One line per
case says what is true, what was told and how far off.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

os.environ["CHLADNI_CACHE"] = "off"  # times of solutions, not of files
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: SuperLU's small blocks gain nothing by two

import numpy as np

from calculix_bricks import solved, write_stl
from calculix_cases import all_cases, responses, study_text, write_measured


def told(diagnosis):
    """The causes, one line each."""
    lines = []
    for cause in diagnosis["causes"]:
        sizes = ", ".join(f"{name} {one['value']:.4g}+-{one['std']:.2g}" for name, one in
                          cause["parameters"].items())
        lines.append(f"  {cause['probability']:.2f} {cause['effect']} {' '.join(cause['channels'])} {sizes}"
                     f"  (ln evidence {cause['log_evidence_gain']:.0f})")
    return lines


def write_case(case, folder, wanted, seed):
    modal = solved(case.body, folder, wanted.modes)
    if case.rig.drawn is not None:
        write_stl(case.rig.drawn(), folder / "body.stl")
    omega = 2 * np.pi * np.linspace(20.0, case.rig.high_hz, wanted.lines)
    g, rng = responses(case, modal, omega, seed)
    write_measured(folder / "measured.csv.gz", omega, g, wanted.noise, rng)
    (folder / "study.toml").write_text(study_text(case.rig))
    truth = None if case.truth is None else [
        {"effect": e, "place": None if p is None else [float(v) for v in p], "size": s} for e, p, s in case.truth]
    (folder / "truth.json").write_text(json.dumps(truth))


def diagnose(chladni, folder):
    start = time.time()
    done = subprocess.run([chladni, "diagnose", "study.toml", "-o", "out", "--quiet", "--no-pictures"], cwd=folder,
                          capture_output=True, text=True,
                          check=False)
    if done.returncode not in (0, 4):
        return None, done.stderr.strip(), time.time() - start
    return json.loads((folder / "out" / "diagnosis.json").read_text()), "", time.time() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("chladni")
    parser.add_argument("out", type=Path)
    parser.add_argument("--cases", default="")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lines", type=int, default=200)
    parser.add_argument("--modes", type=int, default=120)
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--solve-only", action="store_true")
    parser.add_argument("--told", action="store_true", help="only what is in the folders")
    wanted = parser.parse_args()
    if not wanted.told and shutil.which("ccx") is None:
        print("skipped: no ccx (package calculix-ccx)")
        sys.exit(77)
    everything = all_cases()
    chosen = wanted.cases.split(",") if wanted.cases else list(everything)
    for name in chosen:
        folder = wanted.out / name
        if not wanted.told:
            write_case(everything[name], folder, wanted, 1000 * wanted.seed + list(everything).index(name))
        if wanted.solve_only:
            print(name, "solved", flush=True)
            continue
        diagnosis, error, seconds = (
            (json.loads((folder / "out" / "diagnosis.json").read_text()), "", 0.0) if wanted.told
            else diagnose(str(Path(wanted.chladni).resolve()), folder))
        truth = json.loads((folder / "truth.json").read_text())
        print(f"{name} ({seconds:.0f} s): true: {truth}")
        if diagnosis is None:
            print(f"  failed: {error}", flush=True)
            continue
        print(f"  {diagnosis['verdict']}, z after {diagnosis['excess_after']:.1f}", *told(diagnosis), sep="\n",
              flush=True)


if __name__ == "__main__":
    main()
