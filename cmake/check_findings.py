"""Checks that the tests that docs/reference/findings.md names exist.

    check_findings.py SOURCE BUILD

A name is a part of the name of a test: `...` and `*` stand for anything, `{a,b}` for several. Names of a room that has no test in
this build are passed over.
"""

import re
import subprocess
import sys
from pathlib import Path

TEST = re.compile(r"^[a-z_]+\.|^[A-Z]\w+$")
FILES = (".py", ".h", ".cpp", ".md")


def expanded(name):
    braces = re.search(r"\{([^{}]*)\}", name)
    if not braces:
        return [name]
    parts = [part.strip() for part in braces[1].split(",")]
    return [one for part in parts for one in expanded(name[: braces.start()] + part + name[braces.end() :])]


def names_of(page):
    for line in page.splitlines():
        cells = line.split(" | ")
        if not line.startswith("| ") or len(cells) != 3:
            continue
        for name in re.findall(r"`([^`]+)`", cells[1]):
            if TEST.match(name) and not name.endswith(FILES):
                yield from expanded(name)


def tests_of(build):
    told = subprocess.run(["ctest", "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout
    return re.findall(r"^ *Test +#\d+: (.*)$", told, re.M)


def main():
    source, build = sys.argv[1:]
    page = Path(source, "docs/reference/findings.md").read_text()
    tests = tests_of(build)
    rooms = {test.split(".")[0] for test in tests}
    missing = []
    for name in names_of(page):
        pattern = ".*".join(re.escape(part) for part in re.split(r"\.\.\.|\*", name))
        is_built = "." not in name or name.split(".")[0] in rooms
        if is_built and not any(re.search(pattern, test) for test in tests):
            missing.append(name)
    for name in missing:
        print(f"docs/reference/findings.md: there is no test {name}")
    sys.exit(1 if missing else 0)


main()
