"""./chladni looks at every folder that it builds: a change in any of them is built before use.

launcher_test.py ROOT
"""
import fcntl
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
FOLDERS = re.findall(r"^(?:  )?add_subdirectory\((\w+)\)", (ROOT / "CMakeLists.txt").read_text(),
                     re.MULTILINE)
BENCH = "bench"  # no preset of the launcher builds it


class Launcher(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = pathlib.Path(holder.name).resolve() / "tree"
        for folder in FOLDERS:
            (self.root / folder).mkdir(parents=True)
            (self.root / folder / "file.cpp").touch()
        (self.root / "cmake").mkdir()
        for name in ("CMakeLists.txt", "CMakePresets.json", "packages.txt"):
            (self.root / name).touch()
        shutil.copy(ROOT / "chladni", self.root / "chladni")
        self.build = self.root / "build/release"
        self.script(self.build / "bin/chladni", "exit 0")
        self.tools = self.root / "tools"
        for name in ("ctest", "dpkg-query"):
            self.script(self.tools / name, "exit 0")
        self.script(self.tools / "cmake", f'echo "$@" >> {self.root}/asked')
        time.sleep(0.02)
        for stamp in (".programs_built", ".tests_built"):
            (self.build / stamp).touch()
        time.sleep(0.02)

    @staticmethod
    def script(file, line):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"#!/bin/sh\n{line}\n")
        file.chmod(0o755)

    def builds(self, verb):
        """Whether `./chladni verb` asks CMake for anything."""
        asked = self.root / "asked"
        asked.unlink(missing_ok=True)
        path = f"{self.tools}:{os.environ['PATH']}"
        subprocess.run([self.root / "chladni", verb], env=dict(os.environ, PATH=path), check=True,
                       capture_output=True)
        return asked.exists()

    def test_nothing_is_built_where_nothing_changed(self):
        self.assertFalse(self.builds("test"))
        self.assertFalse(self.builds("doctor"))

    def test_a_change_in_any_folder_is_built_before_the_tests(self):
        self.assertIn("python", FOLDERS)
        for folder in FOLDERS:
            if folder == BENCH:
                continue
            (self.root / folder / "file.cpp").touch()
            self.assertTrue(self.builds("test"), folder)
            self.assertFalse(self.builds("test"), folder)

    def run_while_another_builds(self, ready):
        """What `./chladni doctor` says while the lock is held until `ready()`, and its process."""
        path = f"{self.tools}:{os.environ['PATH']}"
        with open(self.build / ".lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            process = subprocess.Popen([self.root / "chladni", "doctor"], stderr=subprocess.PIPE,
                                       env=dict(os.environ, PATH=path), text=True)
            said = process.stderr.readline()
            ready()
        return said, process

    def test_who_waits_for_another_build_says_so_and_holds_no_lock_afterwards(self):
        self.script(self.build / "bin/chladni", f"touch {self.root}/runs; exec sleep 60")
        (self.root / "base" / "file.cpp").touch()
        said, process = self.run_while_another_builds(
            lambda: (self.build / ".programs_built").touch())
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.assertEqual(said, "chladni: waiting for another build\n")
        for _ in range(600):
            if (self.root / "runs").exists():
                break
            time.sleep(0.05)
        self.assertTrue((self.root / "runs").exists())
        self.assertFalse((self.root / "asked").exists())
        with open(self.build / ".lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # else a BlockingIOError

    def test_what_no_program_is_made_of_is_not_built_before_a_verb(self):
        for folder in ("python", "tests"):
            (self.root / folder / "file.cpp").touch()
            self.assertFalse(self.builds("doctor"), folder)
        (self.root / "base" / "file.cpp").touch()
        self.assertTrue(self.builds("doctor"))


if __name__ == "__main__":
    unittest.main()
