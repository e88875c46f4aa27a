"""The module as a user meets it: fields from arrays, fields from a study, refusals."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import chladni
import numpy as np
from studies import patience

STUDY = """
geometry = { plate = { length = "600 mm", width = "500 mm", thickness = "%s" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 14 }
"""
PLACES = [(-250, 210), (240, 190), (200, -100), (-110, -230), (30, 20), (-270, -60), (20, 230)]


def channels():
    return "".join(
        f'[[sensor]]\nname = "s{i}"\nat = ["{x} mm", "{y} mm"]\ndirection = "z"\n'
        for i, (x, y) in enumerate(PLACES))


def spline_case(s=9):
    random = np.random.default_rng(1)
    position = np.column_stack([random.uniform(-0.3, 0.3, (s, 2)), np.zeros(s)])
    direction = np.tile([0.0, 0.0, 1.0], (s, 1))
    places = chladni.Places(position, direction)
    return places, position, chladni.Simulation(np.zeros(0), places, np.ones(s))


class Fields(unittest.TestCase):
    def test_a_plane_is_a_plane_everywhere(self):
        places, position, simulation = spline_case()
        values = (1.0 + 2.0 * position[:, :1] - position[:, 1:2])
        measured = chladni.MeasuredShapes(places, [100.0], values, np.full_like(values, 1e-6))
        field = chladni.mode_field("thin_plate_spline", measured, simulation)
        mean, deviation = field.at(chladni.Places([[0.1, -0.2, 0.0]], [[0.0, 0.0, 1.0]]))
        self.assertAlmostEqual(mean[0, 0], 1.4, places=6)
        self.assertGreaterEqual(deviation[0, 0], 0.0)

    def test_what_cannot_be_meant_is_a_value_error(self):
        places, _, simulation = spline_case(2)
        measured = chladni.MeasuredShapes(places, [100.0], np.ones((2, 1)), np.ones((2, 1)))
        with self.assertRaisesRegex(ValueError, "three or more"):
            chladni.mode_field("thin_plate_spline", measured, simulation)
        with self.assertRaisesRegex(chladni.InvalidInput, "dynamic_residual"):
            chladni.mode_field("kriging", measured, simulation)

    def test_a_study_becomes_a_field(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "real.toml").write_text(STUDY % "21 mm")
            study = folder / "study.toml"
            study.write_text(STUDY % "20 mm" + channels() +
                             '[measurement]\ntruth = "real.toml"\nmodes = 4\n')
            field = chladni.interpolate(study, folder / "out")
            points = np.array([[x / 1e3, y / 1e3, 0.0] for x, y in PLACES])
            mean, deviation = field.at(points)
            self.assertEqual(mean.shape, (7, 4))
            self.assertTrue((deviation > 0).all())
            beside, _ = field.at(points + [0.0, 0.0, 0.001], direction=[0.0, 0.0, 1.0],
                                 method="thin_plate_spline")
            np.testing.assert_allclose(mean[:, 0], beside[:, 0], rtol=0.2, atol=0.02)
            self.assertEqual(len(field.frequency_hz), 4)
            self.assertIn("dynamic_residual", str(field))
            self.assertTrue((folder / "out" / "interpolation.json").exists())
            with self.assertRaisesRegex(ValueError, "was not interpolated by"):
                field.at(points, method="serep")
            field.at([[0.0, 0.0, 0.0009]])
            with self.assertRaisesRegex(
                    chladni.InvalidInput,
                    r"point 1 at \(5000, 5000, 0\) mm is .* mm off the surface of the body"):
                field.at([[0.0, 0.0, 0.0], [5.0, 5.0, 0.0]])


class LongCalls(unittest.TestCase):
    """A study that takes seconds, in a process of its own."""

    PROGRAM = """
import chladni, sys, threading, time
ticks = []
def tick():
    while True:
        ticks.append(time.monotonic())
        time.sleep(0.05)
threading.Thread(target=tick, daemon=True).start()
print("started", flush=True)
try:
    chladni.interpolate(sys.argv[1], sys.argv[2])
    print("done")
except KeyboardInterrupt as stop:
    print("stopped", time.monotonic())
print("longest", max(b - a for a, b in zip(ticks, ticks[1:])))
try:
    time.sleep(0.01)
    __import__("os").kill(__import__("os").getpid(), 2)
    time.sleep(5)
    print("deaf")
except KeyboardInterrupt:
    print("python hears again")
"""

    def started(self, folder):
        large = STUDY.replace('"60 mm", order = 2', '"20 mm", order = 2')
        (folder / "real.toml").write_text(large % "21 mm")
        (folder / "study.toml").write_text(large % "20 mm" + channels() +
                                           '[measurement]\ntruth = "real.toml"\nmodes = 4\n')
        process = subprocess.Popen(
            [sys.executable, "-c", self.PROGRAM, folder / "study.toml", folder / "out"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(process.stdout.readline(), "started\n")
        return process

    def stopped(self, folder):
        """Seconds from Ctrl-C to its exception, and the longest that another thread waited."""
        process = self.started(folder)
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "too small a study to be stopped")
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        said, errors = process.communicate(timeout=60)
        words = said.split()
        self.assertEqual(words[0], "stopped", said + errors)
        self.assertTrue(said.endswith("python hears again\n"), said + errors)
        return float(words[1]) - sent, float(words[3])

    # On a busy machine one of three runs has its processor.
    def test_ctrl_c_raises_and_other_threads_run(self):
        runs = []
        while not runs or (len(runs) < 3 and (runs[-1][0] > 1.0 or runs[-1][1] > 0.5)):
            with tempfile.TemporaryDirectory() as name:
                runs.append(self.stopped(pathlib.Path(name)))
        self.assertLess(min(run[0] for run in runs), 1.0 * patience(), runs)
        self.assertLess(min(run[1] for run in runs), 0.5 * patience(), f"the lock was held: {runs}")

    def test_what_is_thrown_can_be_told_apart(self):
        for error in (chladni.WorkerDied, chladni.OutOfResources):
            self.assertTrue(issubclass(error, chladni.NumericalFailure))
        with tempfile.TemporaryDirectory() as name:
            study = pathlib.Path(name) / "study.toml"
            tets = STUDY.replace("order = 2", 'order = 2, mesher = "tetgen"') % "20 mm"
            study.write_text(tets + channels() + '[measurement]\ntruth = "study.toml"\n')
            false = pathlib.Path(name) / "chladni-tetgen"
            false.write_text("#!/bin/sh\nkill -SEGV $$\n")
            false.chmod(0o755)
            before = os.environ.get("CHLADNI_LIBEXEC")
            os.environ["CHLADNI_LIBEXEC"] = name
            try:
                with self.assertRaisesRegex(chladni.WorkerDied, "chladni-tetgen died"):
                    chladni.interpolate(study, pathlib.Path(name) / "out")
            finally:
                del os.environ["CHLADNI_LIBEXEC"]
                if before is not None:
                    os.environ["CHLADNI_LIBEXEC"] = before


if __name__ == "__main__":
    unittest.main()
