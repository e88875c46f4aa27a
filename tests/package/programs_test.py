"""What ./chladni builds is all that it needs, and all that is installed.

programs_test.py BUILD
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1)).resolve()


def ninja(*words):
    done = subprocess.run(["ninja", "-C", BUILD, *words], check=True, capture_output=True, text=True)
    return done.stdout.splitlines()


@unittest.skipUnless((BUILD / "build.ninja").exists(), "not a build of Ninja's")
class Programs(unittest.TestCase):
    def setUp(self):
        asked = "\n".join(ninja("-t", "query", "programs")).split("outputs:")[0]
        self.built = {line.strip() for line in ninja("-t", "inputs", "programs")} | set(asked.split())

    def test_every_program_is_built_by_the_first_command(self):
        targets = [line.split(":")[0] for line in ninja("-t", "targets", "all")]
        programs = {name for name in targets if re.fullmatch(r"bin/chladni(-[a-z]+)?", name)}
        self.assertIn("bin/chladni-mat", programs)
        self.assertEqual(programs - self.built, set())

    def test_what_the_first_command_built_can_be_installed(self):
        for script in BUILD.glob("**/cmake_install.cmake"):
            for file in re.findall(r'file\(INSTALL .*?FILES "([^"]+)"', script.read_text(), re.DOTALL):
                # What is no output of the build is in the tree, or was written by CMake itself.
                if not file.startswith(f"{BUILD}/") or "/CMakeFiles/" in file:
                    continue
                name = file[len(f"{BUILD}/"):]
                if re.fullmatch(r"chladniConfig\w*\.cmake|python/chladni/_chladni\.[^/]*\.so", name):
                    continue
                self.assertTrue(name in self.built, f"{name} is installed, but not built")

    def test_each_is_there_and_starts(self):
        done = subprocess.run([BUILD / "bin/chladni", "doctor"], check=False, capture_output=True,
                              text=True)
        programs = [n for n in sorted(self.built) if re.fullmatch(r"bin/chladni-[a-z]+", n)]
        self.assertGreaterEqual(len(programs), 4)
        for name in programs:
            self.assertRegex(done.stdout, rf"ok +{name[4:]} +\S+/{name[4:]}\n")

    def test_doctor_tells_what_is_optional_from_what_is_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            programs = pathlib.Path(folder)
            for program in (BUILD / "bin").glob("chladni*"):
                os.symlink(program, programs / program.name)
            (programs / "chladni").unlink()
            shutil.copy2(BUILD / "bin/chladni", programs)  # a link would be followed to the others

            def doctor():
                done = subprocess.run([programs / "chladni", "doctor"], check=False, capture_output=True, text=True,
                                      env={**os.environ, "CHLADNI_LIBEXEC": ""})
                return done.stdout

            if (programs / "chladni-slepc").exists():
                (programs / "chladni-slepc").unlink()
                self.assertRegex(doctor(), r"ok +chladni-slepc +optional, not installed: no modes by the "
                                           r"ranks of MPI; apt-get install chladni-cluster\n")
            (programs / "chladni-tetgen").unlink()
            self.assertRegex(doctor(), r"BAD +chladni-tetgen +meshing of surfaces will not work")


if __name__ == "__main__":
    unittest.main()
