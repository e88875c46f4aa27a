#!/usr/bin/env python3
"""Fails where the README is too long or says what is not so.

check_readme.py ROOT MODULE SAMPLE
What it prints of `chladni diagnose` must be what a tutorial prints, which a test runs. Its C++ must be
the tested one. Its Python runs with the module, at every fourth landing.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
MOST_LINES, MOST_BYTES_OF_PICTURE = 100, 200_000


def block(text, language):
    return re.search(rf"```{language}\n(.*?)```", text, re.DOTALL)[1]


def fault_of_python(code, root, module):
    """What is wrong with the example, run where `models` is; empty if nothing is."""
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "models").symlink_to(root / "models")
        done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True,
                              env=dict(os.environ, PYTHONPATH=str(module)), check=False)
    lines = re.findall(r"first mode at x = +-?\d\.\d m: -?\d\.\d{3} \+- \d\.\d{3}\n", done.stdout)
    if done.returncode or len(lines) != 3:
        return f"the README's Python prints\n{done.stdout}{done.stderr}"
    return ""


def faults_of(root, module, sample):
    readme = (root / "README.md").read_text()
    if readme.count("\n") > MOST_LINES:
        yield f"the README has {readme.count(chr(10))} lines, expected at most {MOST_LINES}"
    picture = root / re.search(r"!\[[^\]]*\]\(([^)]+)\)", readme)[1]
    if picture.stat().st_size > MOST_BYTES_OF_PICTURE:
        yield f"{picture} has more than {MOST_BYTES_OF_PICTURE} bytes"
    tutorial = (root / "docs/tutorials/hidden_thing.md").read_text()
    for line in block(readme, "text").splitlines():
        if f"\n{line}\n" not in tutorial:
            yield f"the README prints a line that docs/tutorials/hidden_thing.md does not:\n{line}"
    if block(readme, "cpp") not in (root / "tests/package/stranger/main.cpp").read_text():
        yield "the README's C++ is not in tests/package/stranger/main.cpp"
    code = block(readme, "python")
    compile(code, "README.md", "exec")
    sys.path.insert(0, str(root / "tests/rotation"))
    from turn import why_skipped
    if why := why_skipped("readme.python", sample, root):
        print(f"its Python {why}")
    elif fault := fault_of_python(code, root, module):
        yield fault


def main():
    root, module, sample = (pathlib.Path(a).resolve() for a in sys.argv[1:])
    faults = list(faults_of(root, module, sample))
    print("\n".join(faults) or "the README tells the truth")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
