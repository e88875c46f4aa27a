#!/usr/bin/env python3
"""Does what a page of docs/tutorials says, in a folder of its own, and compares what is printed.

tutorial_test.py PAGE SOURCE CHLADNI MODULE SAMPLE [dear]
Blocks with a title are files, `sh` blocks are run, and the `text` block after one is what it prints
(page.py says how near). `chladni` is the program, `models` the folder of the source; no pictures are
painted. A page that is dear has its turn at every fourth landing.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
import page

PICTURES = "diagnose identify interpolate modes place study"
LAUNCHER = """#!/bin/sh
for verb in %s; do [ "$1" = $verb ] && exec '%s' "$@" --no-pictures; done
exec '%s' "$@"
"""


def environment(folder, chladni, module):
    launcher = folder / "bin/chladni"
    launcher.parent.mkdir()
    launcher.write_text(LAUNCHER % (PICTURES, chladni, chladni))
    launcher.chmod(0o755)
    (launcher.parent / "python3").symlink_to(sys.executable)  # it has NumPy
    return dict(os.environ, PATH=f"{launcher.parent}:{os.environ['PATH']}", PYTHONPATH=str(module))


def do(text, folder, environ):
    """Follows the page; the first fault ends it."""
    commands = printed = ""
    for language, title, content in page.blocks(text):
        if title:
            (folder / title).write_text(content)
        elif language == "sh":
            commands = content
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=folder,
                                  env=environ, capture_output=True, text=True, check=False)
            printed = done.stdout
            if done.returncode:
                sys.exit(f"{commands}ends with {done.returncode}:\n{printed}{done.stderr}")
        elif language == "text":
            if (line := page.missing_line(content, printed)) is not None:
                sys.exit(f"{commands}does not print\n{line}\nbut\n{printed}")


def main():
    file, source, chladni, module, sample = (pathlib.Path(a).resolve() for a in sys.argv[1:6])
    sys.path.insert(0, str(source / "tests/rotation"))
    from turn import why_skipped
    if "dear" in sys.argv[6:] and (why := why_skipped(f"docs.tutorial.{file.stem}", sample, source)):
        print(why)
        return 77
    with tempfile.TemporaryDirectory(prefix="chladni_tutorial_") as name:
        folder = pathlib.Path(name)
        environ = environment(folder, chladni, module)
        (folder / "models").symlink_to(source / "models")
        do(file.read_text(), folder, environ)
    print(f"{file.name}: every command does what the page says")
    return 0


if __name__ == "__main__":
    sys.exit(main())
