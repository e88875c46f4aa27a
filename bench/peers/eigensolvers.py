#!/usr/bin/python3
"""Peers on the matrices of export_plate: 6 rigid and 20 flexible modes of K x = lambda M x.

eigensolvers.py FOLDER slepc-mumps|slepc-cholmod|scipy [COUNT]

Prints one JSON line: CPU seconds of the solution alone (reading not counted), the peak resident
set of the process in MB, and the flexible frequencies. One thread; run it with
OPENBLAS_CORETYPE=SkylakeX (or whatever the processor has) for the peer at its best and without for
the peer as shipped. Packages: python3-slepc4py python3-petsc4py, python3-scipy."""
import glob
import json
import os
import resource
import sys
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"
import numpy as np  # noqa: E402  (OpenBLAS reads the environment when it is loaded)

SHIFT = -((2.0 * np.pi * 200.0) ** 2)


def csr(path):
    """A matrix of PETSc's binary format: starts, columns and values."""
    with open(path, "rb") as file:
        mark, rows, _, entries = np.fromfile(file, ">i4", 4)
        assert mark == 1211216, path
        start = np.zeros(rows + 1, np.int32)
        start[1:] = np.cumsum(np.fromfile(file, ">i4", rows))
        columns = np.fromfile(file, ">i4", entries).astype(np.int32)
        return start, columns, np.fromfile(file, ">f8", entries).astype(float)


def slepc(folder, package, count):
    for found in glob.glob("/usr/lib/*dir/*3.*/*-real/lib/python3/dist-packages"):
        sys.path.append(found)
        root = found.split("/lib/python3")[0]
        os.environ.setdefault("PETSC_DIR" if "petsc" in root else "SLEPC_DIR", root)
    import slepc4py

    slepc4py.init([sys.argv[0]])
    from petsc4py import PETSc
    from slepc4py import SLEPc

    def matrix(name):
        start, columns, values = csr(os.path.join(folder, name))
        size = len(start) - 1
        made = PETSc.Mat().createAIJ((size, size), csr=(start, columns, values))
        made.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        made.setOption(PETSc.Mat.Option.HERMITIAN, True)
        return made

    k, m = matrix("K.petsc"), matrix("M.petsc")
    begin = time.process_time()
    solver = SLEPc.EPS().create()
    solver.setOperators(k, m)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setDimensions(count)
    solver.setTolerances(1e-9)
    solver.setTarget(SHIFT)
    solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    transform = solver.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    transform.setMatStructure(PETSc.Mat.Structure.SUBSET)
    inner = transform.getKSP()
    inner.setType("preonly")
    inner.getPC().setType("cholesky")
    inner.getPC().setFactorSolverType(package)
    solver.solve()
    found = [solver.getEigenvalue(i).real for i in range(solver.getConverged())]
    return np.sort(found)[:count], time.process_time() - begin


def scipy(folder, count):
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    def matrix(name):
        start, columns, values = csr(os.path.join(folder, name))
        size = len(start) - 1
        return csc_matrix((values, columns, start), shape=(size, size))

    k, m = matrix("K.petsc"), matrix("M.petsc")
    begin = time.process_time()
    factor = splu((k - SHIFT * m).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                  options={"SymmetricMode": True})
    inverse = LinearOperator(k.shape, matvec=factor.solve, dtype=float)
    found = eigsh(k, count, m, sigma=SHIFT, OPinv=inverse, tol=1e-9, return_eigenvectors=True)[0]
    return np.sort(found), time.process_time() - begin


def main():
    folder, peer = sys.argv[1:3]
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 26
    try:
        if peer == "scipy":
            found, seconds = scipy(folder, count)
        else:
            found, seconds = slepc(folder, peer.split("-")[1], count)
    except ImportError as missing:
        print(f"skipped: {peer}: {missing} (packages python3-slepc4py, python3-scipy)", flush=True)
        return 77
    flexible = np.sqrt(found[6:]) / (2.0 * np.pi)
    print(json.dumps({
        "peer": peer,
        "kernel": os.environ.get("OPENBLAS_CORETYPE", "as shipped"),
        "cpu_s": round(seconds, 2),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        "first_hz": round(float(flexible[0]), 6),
        "last_hz": round(float(flexible[-1]), 6),
    }))
    return 0


if __name__ == "__main__":
    sys.exit(main())
