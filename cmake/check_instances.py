#!/usr/bin/env python3
"""Fails when a library of a room holds an instance of its own of one of Eigen's decompositions of dynamic
matrices: such an instance costs 1 to 10 s of compiling in each file that has it.

check_instances.py LIBRARY...

base/decompositions.h names the instances that all files share. A decomposition or a solve of an expression
(`Eigen::LLT<Eigen::MatrixXd>(a * b)`, `llt.solve(a * b)`) is another one: give it a matrix
(`Eigen::MatrixXd(a * b)`)."""
import re
import subprocess
import sys

SHARED = "libchladni_base.a"
# Compiled with other rules for complex products, so with instances of their own.
APART = {"block_functions.cpp.o", "normal_equations.cpp.o"}
REAL = "Matrix<double, -1, -1, 0, -1, -1>"
ANY = r"Matrix<(?:double|std::complex<double>), -1, -1, 0, -1, -1>"
# What does the work: of some the member that takes the matrix, of others the one behind it. Only real systems are
# solved in many files.
WORK = re.compile(
    rf"Eigen::(?:(?:SelfAdjointEigenSolver|EigenSolver|LLT|LDLT)<Eigen::{ANY}.*>::compute<"
    rf"|(?:HouseholderQR|ColPivHouseholderQR|CompleteOrthogonalDecomposition)<Eigen::{ANY} ?>::computeInPlace\b"
    rf"|(?:PartialPivLU|JacobiSVD|BDCSVD)<Eigen::{ANY}.*>::compute\b"
    rf"|(?:LLT|LDLT|HouseholderQR|ColPivHouseholderQR|CompleteOrthogonalDecomposition)<Eigen::{REAL}.*>::_solve_impl\b)")


def instances(library):
    """(object, instance) of what `library` defines."""
    listing = subprocess.run(["nm", "-C", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    member = ""
    for line in listing.splitlines():
        if line.endswith(":"):
            member = line[:-1]
        elif (symbol := line[19:]) and WORK.search(symbol.split("(")[0]):
            yield member, symbol


def main():
    faults = [f"{library}({member}): {instance}" for library in sys.argv[1:]
              if not library.endswith(SHARED) for member, instance in instances(library) if member not in APART]
    print("\n".join(faults) or f"{len(sys.argv) - 1} libraries share their decompositions")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
