"""Whether what the fuzzers compile is closed: every function of ours that one of their sources calls
stands in another of them.

    check_fuzzed.py BUILD SOURCE...

The sources are named as in tests/fuzz/sources.cmake (io/scan). What they define and what they need is
read from the objects of the rooms in the folder BUILD.
"""
import subprocess
import sys
from pathlib import Path


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


def split(line):
    """`name kind value size`; names hold blanks, undefined symbols have no size."""
    words = line.split(" ")
    at = max(i for i, word in enumerate(words) if len(word) == 1 and word.isalpha())
    return " ".join(words[:at]), words[at]


def main():
    build = Path(sys.argv[1])
    defined, needed = set(), {}
    for source in sys.argv[2:]:
        room, name = source.split("/", 1)
        here, there = symbols(build / room / "CMakeFiles" / f"chladni_{room}.dir" / f"{name}.cpp.o")
        defined |= here
        needed.update(dict.fromkeys(there, source))
    missing = sorted(needed.keys() - defined)
    for name in missing:
        print(f"tests/fuzz/sources.cmake: {needed[name]} needs the source of {name}")
    sys.exit(len(missing) > 0)


if __name__ == "__main__":
    main()
