"""The module in an install tree, found where Debian's Python looks, with the workers beside it.

installed_test.py BUILD
"""
import os
import pathlib
import site
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
VERSIONED = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/dist-packages"
STUDY = """
geometry = { plate = { length = "100 mm", width = "80 mm", thickness = "10 mm" } }
material = { youngs_modulus = "%s GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "20 mm", order = 2, mesher = "tetgen" }
modes = { count = 12 }
"""
SENSORS = "".join(
    f'[[sensor]]\nname = "s{i}"\nat = ["{x} mm", "{y} mm"]\ndirection = "z"\n'
    for i, (x, y) in enumerate([(-40, 30), (40, 30), (40, -30), (-40, -30), (5, 5), (-20, 10)]))
PROGRAM = """
import chladni, sys
print(chladni.__file__)
print(chladni.interpolate(sys.argv[1], sys.argv[2]))
"""


def install(prefix, root=None):
    environment = dict(os.environ, **({"DESTDIR": str(root)} if root else {}))
    for component in ("programs", "python"):
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix, "--component", component],
                       check=True, env=environment, stdout=subprocess.DEVNULL)


class Installed(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def interpolates_by(self, packages):
        (self.folder / "real.toml").write_text(STUDY % "71")
        study = self.folder / "study.toml"
        study.write_text(STUDY % "70" + SENSORS + '[measurement]\ntruth = "real.toml"\nmodes = 2\n')
        environment = {k: v for k, v in os.environ.items() if k != "CHLADNI_LIBEXEC"}
        done = subprocess.run([sys.executable, "-c", PROGRAM, study, self.folder / "out"],
                              env=dict(environment, PYTHONPATH=str(packages)), text=True,
                              capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(done.stdout.startswith(str(packages)), done.stdout)
        self.assertIn("dynamic_residual", done.stdout)

    def test_the_mesher_is_found_from_the_build_tree(self):
        self.interpolates_by(BUILD / "python")

    def test_the_mesher_is_found_from_a_prefix(self):
        install(self.folder / "prefix")
        self.interpolates_by(self.folder / "prefix" / VERSIONED)

    def test_it_is_where_debians_python_looks(self):
        looked_at = site.getsitepackages()
        for prefix, packages in (("/usr", "lib/python3/dist-packages"), ("/usr/local", VERSIONED)):
            install(prefix, self.folder / "root")
            there = list((self.folder / "root").glob(f"{prefix[1:]}/{packages}/chladni/_chladni*.so"))
            self.assertEqual(len(there), 1, prefix)
            self.assertIn(f"{prefix}/{packages}", looked_at)


if __name__ == "__main__":
    unittest.main()
