#!/usr/bin/env python3
"""Fails when a room includes one it may not, or what lies in a folder of another room (only what
stands at its top is for others), or when a library is named outside its door.

check_layers.py ROOT [--graph]: with --graph it prints who includes whom, and how often."""
import collections
import pathlib
import re
import sys

GROUND = "base host dense mesh modal"
CORE = f"{GROUND} fem priors placement recordings identification diagnosis"
MAY_INCLUDE = {
    "base": "",
    "host": "base",
    "dense": "base host",
    "mesh": "base host",
    "modal": "base host dense mesh",
    "fem": GROUND,
    "priors": GROUND,
    "placement": f"{GROUND} priors",
    "recordings": GROUND,
    "identification": f"{GROUND} priors recordings",
    "diagnosis": f"{GROUND} fem priors recordings identification",
    "io": CORE,
    "cluster": f"{GROUND} fem io",
    "study": f"{CORE} io",
    "stage": f"{CORE} io cluster study",
    "steps": f"{CORE} io cluster study stage",
    "show": f"{CORE} io cluster study stage steps",
    "sweep": f"{CORE} io cluster study stage steps show",
    "app": f"{CORE} io cluster study stage steps show sweep",
    "python": f"{CORE} io study stage steps show sweep app",
}
DOORS = {
    r"udunits2": ["base/quantity.cpp"],
    r"boost/": ["base/search.cpp"],
    r"tetgen": ["mesh/mesher/tetgen_worker.cpp"],
    r"CGAL/": ["mesh/*/cgal_*.cpp", "mesh/*/cgal_*.h"],
    r"metis": ["fem/factor/metis_order.cpp"],
    r".*mumps|Eigen/CholmodSupport": ["bench/peers/*.cpp"],
    r"cholmod|SuiteSparse": ["fem/factor/cholmod.cpp", "bench/peers/*.cpp"],
    r"cblas|openblas": ["dense/blas.cpp"],
    r"petsc|slepc|mpi\.h": ["cluster/worker/slepc_worker.cpp"],
    r"vtk": ["io/cells/vtu*.cpp", "io/picture/*.cpp", "io/picture/*.h"],
    r"nlohmann/": ["io/bytes/json.cpp"],
    r"matio": ["io/matlab/mat.cpp", "io/matlab/mat_worker.cpp"],
    r"zlib": ["io/bytes/gzip.cpp"],
    r"fftw3": ["recordings/estimate/fft.cpp"],
    r".*\.hxx": ["io/surface/step*.cpp"],
    r"pybind11/": ["python/*.cpp", "python/*.h", "python/*/*.cpp", "python/*/*.h"],
    r"nlopt": ["priors/gaussian_process/optimum.cpp"],
    r"toml": ["study/toml/study_source.cpp"],
    r"CLI/": ["app/main.cpp"],
    r"sstream": ["base/text_stream.h"],
}
# std::to_string prints 1e-14 as 0.000000: fmt::to_string and fmt::format do not. Whole numbers only,
# where fmt is not linked or was not yet.
WHOLE_NUMBERS_ONLY = ["host/atomic_file.cpp", "host/worker.cpp", "mesh/mesher/*", "mesh/patches.cpp",
                      "io/scan.h", "io/matlab/mat_worker.cpp", "io/picture/*", "io/surface/step_worker.cpp"]
# "avx2,fma" makes a clone for AVX2 and one for FMA, not one for both: levels of the architecture have all.
CLONES = "base/cpu_clones.h"
NO_SUCH_NAME = re.compile(r"util|helper|manager|common|misc|stuff")
INCLUDE = re.compile(r'#\s*include [<"]([^>"]+)')
# What may hold a brace or a word that is no code. A ' within a number (1'000) begins no character.
NO_CODE = re.compile(r"""
    R"(\w*)\(.*?\)\1" | "(?:\\.|[^"\\\n])*" | (?<!\w)'(?:\\.|[^'\\\n])+' | //[^\n]* | /\*.*?\*/
    | ^[ \t]*\#(?:\\\n|[^\n])* | \btemplate\s*<[^<>]*> | \[\[.*?\]\]
    """, re.DOTALL | re.MULTILINE | re.VERBOSE)
BRACE = re.compile(r"""
    namespace (?P<space>[\w\s:]*) \{
    | (?<!enum\ ) \b(?:class|struct)\s+ (?P<name>\w+(?:::\w+|<[^;{}]*?>)*) [^;{}()=]* \{
    | [{}]
    """, re.VERBOSE)


def faults_of(root):
    for room, allowed in MAY_INCLUDE.items():
        for file in sorted([*root.glob(f"{room}/**/*.h"), *root.glob(f"{room}/**/*.cpp")]):
            here = file.relative_to(root)
            if NO_SUCH_NAME.search(here.stem):
                yield f"{here}: name it after what it holds"
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if "std::to_string(" in line:
                    if not any(here.match(f) for f in WHOLE_NUMBERS_ONLY):
                        yield f"{here}:{number}: std::to_string hides small numbers, use fmt"
                if "target_clones" in line and not here.match(CLONES):
                    yield f"{here}:{number}: a clone may lack FMA, use CHLADNI_WIDE of {CLONES}"
                if not (m := INCLUDE.match(line)):
                    continue
                target = m[1].split("/")[0]
                if target in MAY_INCLUDE and target != room and target not in allowed.split():
                    yield f"{here}:{number}: {room} may not include {target}"
                elif target in MAY_INCLUDE and target != room and m[1].count("/") > 1:
                    yield f"{here}:{number}: {m[1]} is of {target} alone: include its top level"
                for library, doors in DOORS.items():
                    if re.match(library, m[1]) and not any(here.match(d) for d in doors):
                        yield f"{here}:{number}: {m[1]} belongs in {' or '.join(doors)}"


def classes_of(text):
    """The classes that stand in namespaces with a name: chladni::mesh::Plate. Those of an unnamed
    namespace are the file's own."""
    scopes = []  # of each open brace: the name of a namespace, or "" for all else
    for m in BRACE.finditer(NO_CODE.sub(" ", text)):
        if m["name"] and "" not in scopes:
            yield "::".join([*scopes, m["name"]])
        if m[0] == "}":
            scopes = scopes[:-1]
        else:
            scopes.append((m["space"] or "").strip())


def faults_of_classes(root):
    """Two classes of one name are one to the linker, which keeps the functions of either."""
    files = collections.defaultdict(list)
    for file in sorted(file for room in MAY_INCLUDE for file in root.glob(f"{room}/**/*.*")):
        if file.suffix in (".h", ".cpp"):
            for name in classes_of(file.read_text()):
                files[name].append(str(file.relative_to(root)))
    for name, where in files.items():
        if len(where) > 1:
            yield f"{', '.join(where)}: each defines {name}"


def faults_of_tests(root):
    """Two checkouts, or two users, may run the tests at once: no name in /tmp is the same for both."""
    for file in sorted([*root.glob("tests/**/*.h"), *root.glob("tests/**/*.cpp")]):
        statements = file.read_text().split(";")
        for statement in statements:
            if "temp_directory_path()" in statement and "getpid()" not in statement:
                yield f"{file.relative_to(root)}: a temporary name without the process's number"


def faults_of_page(root):
    """The page of the house has a row for each room and in it each of the room's folders."""
    page = (root / "docs/architecture.md").read_text()
    for room in MAY_INCLUDE:
        row = next((line for line in page.splitlines() if line.startswith(f"| `{room}` |")), None)
        if row is None:
            yield f"docs/architecture.md: no row for {room}"
            continue
        for folder in sorted({file.parent for file in root.glob(f"{room}/*/*.cpp")}):
            if f"`{folder.name}`" not in row:
                yield f"docs/architecture.md: {room} lacks its folder {folder.name}"


def graph(root):
    """The rooms and what they include, with the number of includes, as the code has it."""
    for room in MAY_INCLUDE:
        counts = collections.Counter()
        for file in [*root.glob(f"{room}/**/*.h"), *root.glob(f"{room}/**/*.cpp")]:
            for line in file.read_text().splitlines():
                if (m := INCLUDE.match(line)) and (target := m[1].split("/")[0]) != room:
                    counts[target] += target in MAY_INCLUDE
        edges = [f"{other} {count}" for other, count in counts.items() if count]
        yield f"{room}: {', '.join(sorted(edges)) or '-'}"


def main():
    root = pathlib.Path(sys.argv[1])
    if "--graph" in sys.argv:
        print("\n".join(graph(root)))
        return False
    faults = [*faults_of(root), *faults_of_classes(root), *faults_of_tests(root), *faults_of_page(root)]
    print("\n".join(faults) or "layers hold")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
