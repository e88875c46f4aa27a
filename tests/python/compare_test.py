"""chladni.compare: measured beside simulated."""
import json
import unittest

import chladni
import numpy as np
from studies import HIDDEN, SENSORS, SPRINGS, InFolder, channels, plate, said_by_program

FIVE = {name: SENSORS[name] for name in ("s1", "s2", "s3", "s4", "s5")}
LABORATORY = {"sample_rate": "8192 Hz", "samples": 4096, "periods": 3, "realisations": 3,
              "warm_up": 3, "band": ["100 Hz", "800 Hz"], "noise_ratio": 0.003}


def stage(*hidden, **more):
    return plate(mesh={"edge_length": "70 mm"}, attachment=SPRINGS + list(hidden),
                 modes={"count": 12, "damping_ratio": 0.01}, **channels(FIVE), **more)


class Compare(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        measured = chladni.simulate(stage(HIDDEN, experiment=LABORATORY)).frf
        chladni.write_frf(cls.folder / "measured.csv", measured)
        cls.whole = stage(measurement={"frf": "measured.csv"})
        cls.compared = chladni.compare(chladni.Study(cls.whole, folder=cls.folder))

    def test_errors_are_those_of_the_arrays(self):
        one = self.compared
        measured, off = one.measured.value, one.simulated - one.measured.value
        self.assertEqual(one.simulated.shape, (len(one.measured.frequency_hz), 5, 2))
        size = np.linalg.norm
        np.testing.assert_allclose(one.error, size(off, axis=0) / size(measured, axis=0), rtol=1e-9)
        self.assertAlmostEqual(one.relative_error, size(off) / size(measured), places=9)
        self.assertLess(one.noise_floor, 0.1 * one.relative_error)
        self.assertEqual(one.noise.shape, (5, 2))
        rows = {(row["sensor"], row["actuator"]): row["relative_error"] for row in one.responses}
        self.assertEqual(len(rows), 10)
        self.assertEqual(rows["s2", "a2"], one.error[1, 1])
        f = one.measured.frequency_hz
        for low, high, error in zip(one.band_edges_hz, one.band_edges_hz[1:], one.band_error):
            inside = (f > low) & (f < high)  # a line on an edge belongs to one of both
            wide = (f >= low) & (f <= high)
            bounds = [size(off[lines]) / size(measured[lines]) for lines in (inside, wide)]
            self.assertGreater(error, 0.98 * min(bounds))
            self.assertLess(error, 1.02 * max(bounds))
        self.assertEqual([row["name"] for row in one.sensors], list(FIVE))
        self.assertEqual([row["name"] for row in one.actuators], ["a1", "a2"])

    def test_a_mass_lowers_frequencies(self):
        table = self.compared.table
        self.assertGreater(len(table), 3)
        self.assertLess(max(row["change"] for row in table), 1e-3)
        self.assertLess(min(row["change"] for row in table), -0.005)
        for row in table:
            self.assertAlmostEqual(row["measured_hz"] / row["simulated_hz"] - 1, row["change"])
        mac = self.compared.to_dict()["mac"]
        np.testing.assert_array_equal(self.compared.mac, mac["value"])
        for row in table:
            pair = (mac["simulated_modes"].index(row["simulated_mode"]),
                    mac["measured_modes"].index(row["measured_mode"]))
            self.assertAlmostEqual(self.compared.mac[pair], row["mac"], delta=0.05)

    def test_modes_of_a_file_stand_beside_the_simulated_ones(self):
        hz = chladni.modes(stage(HIDDEN)).frequency_hz
        flexible = hz[hz > 150][:4]
        (self.folder / "modes.csv").write_text(
            "frequency_hz\n" + "".join(f"{one:.9f}\n" for one in flexible))
        one = chladni.compare(chladni.Study(stage(measurement={"modes": "modes.csv"}),
                                            folder=self.folder))
        np.testing.assert_allclose([row["measured_hz"] for row in one.table], flexible, rtol=1e-9)
        self.assertLess(max(row["change"] for row in one.table), 1e-6)
        self.assertIsNone(one.table[0]["mac"])  # no shape was measured
        self.assertEqual((one.responses, one.sensors, one.actuators), ([], [], []))
        self.assertEqual([one.relative_error, one.noise_floor, one.measured, one.simulated],
                         [None] * 4)
        self.assertEqual(one.error.size + one.band_error.size + one.mac.size, 0)
        one.save(self.folder / "of_modes")
        self.assertEqual([file.name for file in (self.folder / "of_modes").iterdir()],
                         ["comparison.json"])

    def test_it_leaves_what_the_program_leaves(self):
        self.compared.save(self.folder / "saved", pictures=False)
        saved = json.loads((self.folder / "saved" / "comparison.json").read_text())
        theirs = said_by_program("compare", self.whole, self.folder)
        mine = self.compared.to_dict()
        self.assertEqual({key: theirs[key] for key in mine}, mine)
        self.assertEqual({key: saved[key] for key in mine}, mine)
        self.assertIn("MAC", str(self.compared))

    def test_figures_are_drawn_from_what_it_leaves(self):
        self.compared.save(self.folder / "drawn")
        there = chladni.figure(self.folder / "drawn", draw=False)["figures"]
        self.assertEqual({one["name"]: one["files"] for one in there},
                         dict.fromkeys(("frequency_errors", "mac", "errors", "responses"), []))
        told = chladni.figure(self.folder / "drawn", ["mac", "responses:s2/a2"],
                              folder=self.folder / "paper", width_mm=88, formats=["svg"])
        self.assertEqual([one["files"] for one in told["figures"]],
                         [["mac.svg"], ["responses_s2_a2.svg"]])
        svg = (self.folder / "paper" / "responses_s2_a2.svg").read_text()
        for words in ('width="88mm"', "s2 by a2", "phase [deg]", "frequency [Hz]", "measured",
                      "simulated"):
            self.assertIn(words, svg)
        stored = json.loads((self.folder / "drawn" / "responses_curves.json").read_text())
        size = np.abs(self.compared.measured.value)
        for one in stored["responses"]:
            i, j = list(FIVE).index(one["name"][:2]), ["a1", "a2"].index(one["name"][6:8])
            np.testing.assert_allclose(one["values"][2], size[:, i, j], rtol=1e-6)

    def test_a_figure_that_cannot_be_meant_is_refused(self):
        self.compared.save(self.folder / "refused")
        for pattern, more in (("no figure \"mca\"", {"name": "mca"}),
                              ("no curves of \"s9/a1\"", {"name": "responses:s9/a1"}),
                              ("\"mac\" has no parts", {"name": "mac:s1/a1"}),
                              ("width of 40 to 400 mm", {"width_mm": 8}),
                              ("expected 50 to 1200", {"dpi": 5000}),
                              ("\"pdf\" is not known", {"formats": ["pdf"]})):
            with self.assertRaisesRegex(chladni.InvalidInput, pattern):
                chladni.figure(self.folder / "refused", **more)

    def test_what_its_progress_raises_ends_it(self):
        def stop(step, part):
            raise KeyboardInterrupt(step)
        with self.assertRaises(KeyboardInterrupt):
            chladni.compare(self.compared.study, progress=stop)

    def test_it_asks_for_a_measurement(self):
        steps = []
        with self.assertRaisesRegex(chladni.InvalidInput, "nothing is measured; expected"):
            chladni.compare(stage(), progress=lambda step, part: steps.append(step))
        self.assertEqual(steps, [])


if __name__ == "__main__":
    unittest.main()
