#!/usr/bin/env python3
"""Solves an exported body by SciPy alone, from both formats, and compares it with the program's modes.

export_test.py CHLADNI: exit code 77 without SciPy."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import scipy.io
    import scipy.sparse
except ImportError as missing:
    print(f"skipped: {missing} (python3-scipy)")
    sys.exit(77)

STUDY = """title = "small plate"
geometry = { plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "10 mm", order = 2 }
modes = { count = 8 }
"""


def petsc(path):
    """A matrix of PETSc's binary format."""
    with open(path, "rb") as file:
        mark, rows, columns, entries = np.fromfile(file, ">i4", 4)
        assert mark == 1211216, path
        starts = np.concatenate([[0], np.cumsum(np.fromfile(file, ">i4", rows))])
        at = np.fromfile(file, ">i4", entries)
        values = np.fromfile(file, ">f8", entries).astype(float)
        assert not file.read(1), "bytes are left over"
    return scipy.sparse.csr_matrix((values, at.astype(int), starts), (rows, columns))


def main():
    chladni = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="chladni_export_") as name:
        folder = pathlib.Path(name)
        (folder / "study.toml").write_text(STUDY)
        for verb in (["export"], ["modes", "--no-pictures"]):
            subprocess.run([chladni, *verb, "study.toml", "-o", "out"], cwd=folder, check=True)
        system = folder / "out/system"
        for matrix in ("stiffness", "mass"):
            one, other = petsc(system / f"{matrix}.petsc"), scipy.io.mmread(system / f"{matrix}.mtx")
            assert abs(one - other.tocsr()).max() == 0.0, f"{matrix}: the two formats differ"
            assert abs(one - one.T).max() == 0.0
        script = (system / "solve.py").read_text()
        assert len(script.splitlines()) <= 16, script
        said = subprocess.run([sys.executable, system / "solve.py"], check=True, capture_output=True,
                              text=True).stdout
        found = np.array([float(word) for word in re.findall(r"\S+", said)])
        truth = np.array(json.loads((folder / "out/modes.json").read_text())["frequency_hz"])
        assert len(found) == len(truth) == 14, (found, truth)
        worst = np.abs(found[6:] / truth[6:] - 1.0).max()
        assert worst < 1e-9, worst
        print(f"SciPy finds the program's frequencies to {worst:.1e}")


if __name__ == "__main__":
    main()
