"""chladni.experiment: what is to be played, and whether it keeps the limits of the rig."""
import pathlib
import tempfile
import unittest
import warnings

import chladni
import numpy as np
from studies import said_by_program

CANTILEVER = {
    "title": "cantilever",
    "geometry": {"beam": {"length": "300 mm", "width": "40 mm", "thickness": "6 mm"}},
    "material": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33, "density": "2700 kg/m^3"},
    "mesh": {"edge_length": "40 mm"},
    "modes": {"count": 6, "damping_ratio": 0.01},
    "support": [{"patch": "x_min", "fixed": "xyz"}],
    "sensor": [{"name": "tip", "at": ["145 mm", "12 mm"], "direction": "z"},
               {"name": "middle", "at": ["20 mm", "-12 mm"], "direction": "z"}],
    "actuator": [{"name": "coil1", "at": ["145 mm", "12 mm", "-6 mm"], "direction": "z"},
                 {"name": "coil2", "at": ["-30 mm", "-12 mm", "-6 mm"], "direction": "z"}],
}
RIG = {"sample_rate": "4096 Hz", "band": ["20 Hz", "1000 Hz"], "inputs": "orthogonal",
       "noise": "1 um"}
DESIGN = {"force": "2 N", "stroke": "0.5 mm", "frequency_deviation": "0.05 Hz",
          "damping_deviation": 0.05, "longest": "15 min", "realisations": 2}
VOLTS = {**DESIGN, "voltage": "10 V", "force_per_volt": "0.3 N/V"}


def study(**more):
    return {**CANTILEVER, "experiment": RIG, "design": DESIGN, **more}


class Multisine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", chladni.ChladniWarning)
        cls.modes = chladni.modes(study())
        cls.newtons = chladni.experiment(cls.modes)
        cls.volts = chladni.experiment(study(design=VOLTS))

    def test_a_period_has_the_amplitudes_on_its_lines(self):
        one = self.newtons
        excitation = one.excitation
        self.assertEqual([channel.name for channel in excitation.inputs], ["coil1", "coil2"])
        self.assertEqual({channel.unit for channel in excitation.inputs}, {"N"})
        self.assertEqual(len(excitation.records), 4)  # 2 realisations of 2 experiments
        period = excitation.period
        self.assertAlmostEqual(excitation.sample_time_s * 4096, 1.0)
        lines = np.round(one.line_hz * period / 4096).astype(int)
        np.testing.assert_allclose(lines * 4096 / period, one.line_hz, rtol=1e-12)
        for record in excitation.records:
            self.assertEqual(record.inputs.shape, (period, 2))
            spectrum = abs(np.fft.rfft(record.inputs, axis=0)) * 2 / period
            np.testing.assert_allclose(spectrum[lines], one.amplitude, rtol=1e-9)
            rest = np.delete(spectrum, lines, axis=0)
            self.assertLess(rest.max(), 1e-9 * one.amplitude.max())

    def test_a_sequence_fades_in_settles_repeats_and_fades_out(self):
        one, told = self.newtons, self.newtons.to_dict()
        for number, record in enumerate(one.excitation.records):
            played = one.sequence(record.realisation, record.experiment)
            period, settle = one.excitation.period, told["settle_periods"]
            recorded = played[settle * period:(settle + told["periods"]) * period]
            self.assertEqual(len(played), (settle + told["periods"]) * period + told["ramp_samples"])
            np.testing.assert_array_equal(recorded, np.tile(record.inputs, (told["periods"], 1)),
                                          str(number))
            self.assertLess(abs(played[[0, -1]]).max(), 0.01 * abs(played).max())
            self.assertLessEqual(abs(played).max(), 2.0)
        peak = max(row["peak_n"] for row in one.forces)
        self.assertLessEqual(peak, 0.8 * 2.0 * (1 + 1e-9))  # with the margin
        for wrong in ((2, 0), (0, 2), (-1, 0)):
            with self.assertRaises(chladni.InvalidInput):
                one.sequence(*wrong)

    def test_volts_are_newtons_over_the_force_of_a_volt(self):
        self.assertEqual((self.newtons.unit, self.volts.unit), ("N", "V"))
        played, told = self.volts.sequence(1, 1), self.volts.to_dict()
        self.assertLessEqual(abs(played).max(), 10.0)
        self.assertAlmostEqual(told["wav_full_scale"] * 0.3,
                               max(row["peak_n"] for row in self.volts.forces))
        np.testing.assert_allclose(
            np.abs(np.fft.rfft(self.volts.excitation.records[0].inputs, axis=0)).max() * 0.3,
            self.volts.amplitude.max() * self.volts.excitation.period / 2, rtol=1e-9)

    def test_the_table_has_the_modes_in_the_band(self):
        one = self.newtons
        hz = self.modes.frequency_hz
        inside = hz[(hz > 20) & (hz < 1000)]
        np.testing.assert_allclose([row["frequency_hz"] for row in one.table], inside, rtol=1e-9)
        for row in one.table:
            if row["reached"]:
                self.assertLessEqual(row["frequency_std_hz"], 0.05 * 1.001)
                self.assertLessEqual(row["damping_std"], 0.05 * 0.01 * 1.001)
                self.assertEqual(row["why"], "")
            else:
                self.assertNotEqual(row["why"], "")
        self.assertTrue(any(row["reached"] for row in one.table))
        self.assertEqual(len(one.coherence), 4)
        self.assertEqual(one.kind, "multisine")
        self.assertIn(one.verdict, str(one))
        self.assertEqual(one.points.shape, (0, 3))
        self.assertGreater(one.duration_s, 1.0)

    def test_it_leaves_what_the_program_leaves(self):
        whole = study(design=VOLTS)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            self.volts.save(folder / "saved", pictures=False)
            left = {file.name for file in (folder / "saved").iterdir()}
            self.assertEqual(left, {*self.volts.to_dict()["files"], "experiment.json"})
            self.assertIn("excitation_r2_e2.wav", left)
            theirs = said_by_program("experiment", whole, folder)
            mine = self.volts.to_dict()
            self.assertEqual({key: theirs[key] for key in mine}, mine)
            for file in mine["files"]:
                if not file.endswith(".mat"):  # its header has the time
                    self.assertEqual((folder / "saved" / file).read_bytes(),
                                     (folder / "out" / file).read_bytes(), file)
            again = chladni.read_time(folder / "saved" / "excitation.csv",
                                      actuators=["coil1", "coil2"])
            np.testing.assert_allclose(again.records[3].inputs,
                                       self.volts.excitation.records[3].inputs, rtol=1e-12)

    def test_a_rate_of_no_whole_hertz_has_no_wav(self):
        one = chladni.experiment(study(experiment={**RIG, "sample_rate": "4096.5 Hz"}))
        self.assertNotIn("wav_full_scale", one.to_dict())
        with tempfile.TemporaryDirectory() as name:
            one.save(name, pictures=False)
            left = {file.name for file in pathlib.Path(name).iterdir()}
        self.assertEqual(left, {"excitation.csv", "excitation.mat", "experiment.json"})
        self.assertEqual(one.to_dict()["files"], ["excitation.csv", "excitation.mat"])

    def test_what_lacks_is_refused_before_it_solves(self):
        for key, pattern in (("design", r"no \[design\]; expected"),
                             ("experiment", r"no \[experiment\]; expected"),
                             ("sensor", "needs a sensor"), ("actuator", "needs an actuator")):
            steps = []
            whole = {name: value for name, value in study().items() if name != key}
            with self.assertRaisesRegex(chladni.InvalidInput, pattern):
                chladni.experiment(whole, progress=lambda step, part: steps.append(step))
            self.assertEqual(steps, [], key)


class Hammer(unittest.TestCase):
    def test_blows_are_on_the_faces(self):
        design = {"kind": "hammer", "force": "100 N", "on": ["top"], "damping_deviation": 0.05}
        whole = study(design=design)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", chladni.ChladniWarning)
            one = chladni.experiment(whole)
        self.assertEqual(one.kind, "hammer")
        self.assertGreater(len(one.points), 0)
        np.testing.assert_allclose(one.points[:, 2], 0.0, atol=1e-12)
        np.testing.assert_allclose(one.normals, np.tile([0.0, 0.0, 1.0], (len(one.points), 1)),
                                   atol=1e-12)
        told = [row["at_m"] for row in one.to_dict()["points"]]
        np.testing.assert_array_equal(told, one.points)
        self.assertIsNone(one.excitation)
        self.assertEqual((one.line_hz.size, one.amplitude.size, one.forces), (0, 0, []))
        with self.assertRaisesRegex(chladni.InvalidInput, "a hammer test plays no signals"):
            one.sequence()
        with tempfile.TemporaryDirectory() as name:
            one.save(name, pictures=False)
            rows = np.loadtxt(pathlib.Path(name) / "hammer_points.csv", delimiter=",", skiprows=1)
        np.testing.assert_allclose(rows.reshape(-1, 6)[:, :3], one.points, atol=1e-9)


if __name__ == "__main__":
    unittest.main()
