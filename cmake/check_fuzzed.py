"""Whether what the fuzzers compile is closed: every function of ours that one of their sources calls
stands in another of them.

    check_fuzzed.py ROOT BUILD parsers|measured SAMPLE SOURCE... -- COMPILER FLAGS...

The sources are named as in tests/fuzz/sources.cmake (io/scan). What they define and what they need is
read from the objects of the rooms in the folder BUILD, or from objects made for it where the rooms
compile several files as one. That takes half a minute: each has its turn at every fourth number that
the program SAMPLE prints, the parsers at 0, what is measured at 2 (tests/rotation).
"""
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def objects_of(folder, sources, root, build, compiler, made):
    """The objects of a folder's sources: those of its room, or one of all made in the folder `made`."""
    room = folder.split("/", 1)[0]
    library = build / room / "CMakeFiles" / f"chladni_{room}.dir"
    objects = [library / f"{source.split('/', 1)[1]}.cpp.o" for source in sources]
    if all(path.exists() for path in objects):
        return objects
    path = Path(made) / (folder.replace("/", "_") + ".o")
    text = "".join(f'#include "{source}.cpp"\n' for source in sources)
    subprocess.run([*compiler, "-O0", f"-I{root}", "-x", "c++", "-c", "-", "-o", path],
                   input=text, text=True, check=True)
    return [path]


def symbols(path):
    """Names of ours that the object defines, and those that it needs."""
    done = subprocess.run(["nm", "--demangle", "--format=posix", path],
                          stdout=subprocess.PIPE, text=True, check=True)
    defined, needed = set(), set()
    for line in done.stdout.splitlines():
        name, kind = split(line)
        if "chladni::" in name:
            (needed if kind == "U" else defined).add(name)
    return defined, needed


LINE = re.compile(r"(.*?) ([A-Za-z])(?: [0-9a-f]+){0,2} *")


def split(line):
    """`name kind value size`; names hold blanks, undefined symbols have no size."""
    return LINE.fullmatch(line).groups()


def main():
    root, build = Path(sys.argv[1]), Path(sys.argv[2])
    end = sys.argv.index("--")
    sources, compiler = sys.argv[5:end], sys.argv[end + 1:]
    sys.path.insert(0, str(root / "tests" / "rotation"))
    from turn import drawn_number
    number = drawn_number(sys.argv[4], root)
    if number is not None and number % 4 != 2 * (sys.argv[3] == "measured"):
        print(f"has its turn at another landing than number {number}: CHLADNI_STUDIES=all runs it")
        sys.exit(77)
    folders = {}
    for source in sources:
        folders.setdefault(source.rsplit("/", 1)[0], []).append(source)
    defined, needed = set(), {}
    with tempfile.TemporaryDirectory() as made, \
            concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        found = pool.map(lambda f: objects_of(f, folders[f], root, build, compiler, made), folders)
        for folder, objects in zip(folders, found):
            for path in objects:
                here, there = symbols(path)
                defined |= here
                needed.update(dict.fromkeys(there, folder))
    missing = sorted(needed.keys() - defined)
    for name in missing:
        print(f"tests/fuzz/sources.cmake: a source of {needed[name]} needs that of {name}")
    sys.exit(len(missing) > 0)


if __name__ == "__main__":
    main()
