"""pip install . : the wheel from a built tree, in an environment of its own.

wheel_test.py SOURCE BUILD
"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(2)).resolve()
SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
PROGRAM = """
import chladni, pathlib, sys
study = {"geometry": {"plate": {"length": "100 mm", "width": "80 mm", "thickness": "10 mm"}},
         "material": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33, "density": "2700 kg/m^3"},
         "mesh": {"edge_length": "20 mm", "order": 2, "mesher": "tetgen"}, "modes": {"count": 3}}
modes = chladni.modes(study)
print(chladni.__file__)
print(len(modes.frequency_hz), modes.complete)
print(chladni._chladni._program())
"""


def run(*words, **more):
    # A kernel that a run of the tests asks for may be one that the doctor rightly calls slow.
    clean = {name: value for name, value in os.environ.items()
             if name not in ("PYTHONPATH", "CHLADNI_LIBEXEC", "OPENBLAS_CORETYPE")}
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          check=False, env=clean, **more)
    if done.returncode:
        raise AssertionError(f"{words} ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


@unittest.skipIf(importlib.util.find_spec("ensurepip") is None,
                 "python3-venv is not installed: the wheel is not tried")
class Wheel(unittest.TestCase):
    def test_pip_installs_the_package_with_its_programs(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            run(sys.executable, "-m", "venv", "--system-site-packages", folder / "own")
            python = folder / "own/bin/python"
            run(python, "-m", "pip", "install", "--no-index", "--no-deps", SOURCE,
                "--config-settings", f"build-dir={BUILD}", cwd=folder)
            told = run(python, "-W", "ignore", "-c", PROGRAM, cwd=folder).splitlines()
            package = next(folder.glob("own/lib/python3*/site-packages/chladni"))
            self.assertEqual(told, [str(package / "__init__.py"), "9 True",
                                    str(package / "bin/chladni")])
            version = run(folder / "own/bin/chladni", "--version")
            self.assertEqual(version, run(python, "-m", "chladni", "--version"))
            self.assertIn(run(python, "-m", "pip", "show", "chladni").split("Version: ")[1]
                          .split()[0], version.replace("-", "."))
            doctor = run(folder / "own/bin/chladni", "doctor")
            self.assertIn(str(package / "libexec/chladni/chladni-tetgen"), doctor)
            run(python, "-m", "pip", "uninstall", "-y", "chladni")
            self.assertFalse(package.exists())


if __name__ == "__main__":
    unittest.main()
