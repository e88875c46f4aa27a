#!/usr/bin/env python3
"""Fails when the README's study does not give what it prints, or its C++ is not the tested one.

check_readme.py ROOT CHLADNI
"""
import pathlib
import re
import subprocess
import sys
import tempfile


def block(text, language):
    return re.search(rf"```{language}\n(.*?)```", text, re.DOTALL)[1]


def frequencies(table):
    """Mode number and frequency of every line that begins with both."""
    return [(int(n), float(f)) for n, f in re.findall(r"^ *(\d+) +(\d+\.\d+)", table, re.MULTILINE)]


def printed(chladni, study):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "beam.toml"
        file.write_text(study)
        command = [chladni, "modes", file, "-o", f"{folder}/out", "--no-pictures"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"the README's study ends with {done.returncode}:\n{done.stderr}")
        return done.stdout


def faults_of(root, chladni):
    readme = (root / "README.md").read_text()
    promised, found = block(readme, "text"), printed(chladni, block(readme, "toml"))
    pairs = zip(frequencies(promised), frequencies(found))
    same = all(a[0] == b[0] and abs(a[1] - b[1]) <= 1e-3 * max(b[1], 1.0) for a, b in pairs)
    if not same or len(frequencies(promised)) != len(frequencies(found)) or not frequencies(found):
        yield f"the README promises\n{promised}\nthe program prints\n{found}"
    if block(readme, "cpp") not in (root / "tests/package/stranger/main.cpp").read_text():
        yield "the README's C++ is not in tests/package/stranger/main.cpp"


def main():
    faults = list(faults_of(pathlib.Path(sys.argv[1]), sys.argv[2]))
    print("\n".join(faults) or "the README tells the truth")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
