"""The steps of the flow from Python: what the program leaves, and what is true."""
import pathlib
import sys
import tempfile
import unittest
import unittest.mock
import warnings

import chladni
import numpy as np
from chladni import _progress
from chladni._toml import toml_text
from studies import (HIDDEN, SPRINGS, InFolder, channels, every_fourth_landing, plate,
                     said_by_program)

EXPERIMENT = {"sample_rate": "16384 Hz", "samples": 8192, "periods": 3, "realisations": 3,
              "warm_up": 3, "band": ["100 Hz", "1450 Hz"], "noise_ratio": 0.01}
MODES = {"count": 12, "damping_ratio": 0.01}
SEARCH = {"on": ["top"], "effects": ["point_mass", "ground_spring"], "most_causes": 1, "lines": 80}
HEAD = {"chladni", "study", "seed", "seconds"}  # of every JSON file
POINT = {"name": "p", "at": ["-20 mm", "-60 mm"]}


def stage(**more):
    return plate(attachment=SPRINGS, modes=MODES, measurement={"frf": "measured.csv"}, **channels(),
                 **more)


class Flow(InFolder):
    """A plate on springs with a hidden mass is measured; the study does not know of the mass."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        real = stage(experiment=EXPERIMENT)
        real["attachment"] = SPRINGS + [HIDDEN]
        cls.real = chladni.Study(real, folder=cls.folder)
        cls.experiment = chladni.simulate(cls.real)
        chladni.write_frf(cls.folder / "measured.csv", cls.experiment.frf)
        cls.study = chladni.Study(stage(interpolation={"point": [POINT]},
                                        diagnosis=SEARCH), folder=cls.folder)
        cls.real_modes = chladni.modes(cls.real)
        cls.modes = chladni.modes(cls.study)

    def test_the_experiment_is_the_simulation_with_noise(self):
        measured = self.experiment.frf
        self.assertIsNone(self.experiment.recordings)
        exact = self.real_modes.frf(measured.frequency_hz)
        off = abs(measured.value - exact.value) ** 2 / measured.variance
        self.assertLess(np.median(off), 3)
        self.assertGreater(np.median(off), 0.1)

    def test_identified_modes_are_those_of_the_real_plate(self):
        model = chladni.identify(self.study)
        real = self.real_modes.frequency_hz
        inside = real[(real > 150) & (real < 1400)]
        for frequency in inside:
            nearest = np.argmin(abs(model.frequency_hz - frequency))
            self.assertLess(abs(model.frequency_hz[nearest] - frequency),
                            6 * model.frequency_std_hz[nearest] + 1e-4 * frequency)
        f = self.experiment.frf.frequency_hz
        fitted = model.frf(f).value
        measured = model.measured.value
        error = np.linalg.norm(fitted - measured) / np.linalg.norm(measured)
        self.assertAlmostEqual(error, model.error, places=9)
        self.assertLess(error, 1.5 * model.noise)
        s = 2j * np.pi * f
        p = model.poles
        self.assertTrue((p.imag >= 0).all() and (p.real <= 0).all())
        modal = np.einsum("im,mj,km->kij", model.output_matrix, model.input_matrix,
                          1 / ((s[:, None] - p) * (s[:, None] - p.conj())))
        summed = (modal + model.residual) * np.exp(-s * model.delay_s)[:, None, None]
        np.testing.assert_allclose(fitted, summed, atol=1e-9 * abs(fitted).max())
        causal = fitted * np.exp(s * min(model.delay_s, 0.0))[:, None, None]  # it cannot look ahead
        np.testing.assert_allclose(model.state_space().frf(f), causal,
                                   atol=1e-6 * abs(fitted).max())
        self.assertIn(model.trust, ("down to the noise", "good", "systematic errors"))

    def test_a_fit_is_told_as_the_program_tells_it(self):
        """With what a fit of recordings alone has, and one with channels that have places."""
        recorded = stage(experiment={**EXPERIMENT, "leaves": "time"})
        recordings = chladni.simulate(chladni.Study(recorded, folder=self.folder)).recordings
        chladni.write_time(self.folder / "recordings.csv", recordings)
        whole = {**stage(), "measurement": {"time": "recordings.csv"}}
        model = chladni.identify(chladni.Study(whole, folder=self.folder))
        said, mine = said_by_program("identify", whole, self.folder), model.to_dict()
        self.assertEqual(set(said) - HEAD, set(mine))
        self.assertEqual(said["data_quality"]["verdict"], mine["data_quality"]["verdict"])
        self.assertEqual(set(said["rigid_body"]), set(mine["rigid_body"]))
        self.assertIn(mine["data_quality"]["verdict"], str(model))
        for side in ("sensors", "actuators"):
            self.assertIn(mine["rigid_body"][side]["told"], str(model))

    def test_shapes_and_responses_between_the_sensors(self):
        field = chladni.interpolate(self.study)
        point = [[-0.02, -0.06, 0.0]]
        f = np.linspace(150, 900, 57)
        value, deviation = field.frf(point, f, direction=[0, 0, 1])
        self.assertEqual(value.shape, (57, 1, 2))
        self.assertTrue((deviation > 0).all())
        shapes = self.real_modes.at(point, [0, 0, 1])[0]
        at_inputs = self.real_modes.at([one.position for one in
                                        self.real_modes.frf([100.0]).inputs], [0, 0, 1])
        omega, s = 2 * np.pi * self.real_modes.frequency_hz, 2j * np.pi * f[:, None]
        dynamic = s ** 2 + 2 * self.real_modes.damping_ratio * omega * s + omega ** 2
        exact = np.einsum("m,jm,km->kj", shapes, at_inputs, 1 / dynamic)
        error = np.linalg.norm(value[:, 0] - exact) / np.linalg.norm(exact)
        self.assertLess(error, 0.15)
        mean, _ = field.at(point, [0, 0, 1])
        self.assertEqual(mean.shape, (1, len(field.frequency_hz)))
        self.assertGreater(len(field.identified.frequency_hz), 3)
        field.save(self.folder / "field", pictures=False)
        band = chladni.read_frf(self.folder / "field" / "predicted_band.csv", unit="m")
        value, deviation = field.frf(point, band.frequency_hz, direction=[0, 0, 1])
        row = [one.name for one in band.outputs].index("p")
        np.testing.assert_allclose(value[:, 0], band.value[:, row], rtol=1e-9)
        np.testing.assert_allclose(deviation[:, 0] ** 2, band.variance[:, row], rtol=1e-9)
        for asked in (lambda f: field.frf(point, f), field.identified.frf,
                      field.identified.state_space().frf):
            for wrong in ([np.nan], [100.0, -3.0], [np.inf]):
                with self.assertRaisesRegex(chladni.InvalidInput,
                                            "frequency_hz has .*; expected 0 or more"):
                    asked(wrong)
        with self.assertRaisesRegex(chladni.InvalidInput, "frequency_hz has 200 after 300; expected"):
            field.identified.frf([300.0, 200.0])
        with self.assertRaisesRegex(chladni.InvalidInput, r"points has the shape \(1, 2\)"):
            field.at([[0, 0]])

    @every_fourth_landing(3)
    def test_the_hidden_mass_is_found(self):
        found = chladni.diagnose(self.study)
        self.assertEqual(found.verdict, "named", found)
        cause = found.causes[0]
        self.assertEqual(cause.effect, "point_mass")
        mass = cause.parameters["mass"]
        self.assertEqual(mass.unit, "kg")
        self.assertLess(abs(mass.value - 0.040), 6 * mass.std + 1e-3)
        np.testing.assert_allclose(cause.place[:2], [0.060, 0.040], atol=4e-3)
        self.assertGreater(cause.probability, 0.9)
        self.assertIn("point_mass", str(cause))
        self.assertLess(found.gain["fit"]["after"], 0.1 * found.gain["fit"]["before"])
        places, explained, probability = found.cause_map
        best = places[np.argmax(probability)]
        self.assertLess(np.linalg.norm(best - cause.place), 0.03)
        self.assertEqual(len(explained), len(places))
        before, extended, _ = found.predictions
        measured = found.measured.value
        self.assertLess(np.linalg.norm(extended - measured), 0.3 * np.linalg.norm(before - measured))
        better = chladni.modes(found.extended_study())
        real = self.real_modes.frequency_hz
        self.assertLess(abs(better.frequency_hz - real)[4:10].max(),
                        abs(self.modes.frequency_hz - real)[4:10].max())
        self.assertIn("&lt;/html&gt;", found._repr_html_())
        found.save(self.folder / "deeper" / "found", pictures=False)
        left = chladni.Study(self.folder / "deeper" / "found" / "extended.toml",
                             allow_outside=[self.folder])  # its measurement is in another folder
        self.assertEqual(left.check()["attachments"], found.extended_study().check()["attachments"])
        self.assertIn("point_mass", found.extended_text)


class Placement(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", chladni.ChladniWarning)
            cls.modes = chladni.modes(plate(placement={"modes": 3}, **channels()))
            cls.placement = chladni.place(cls.modes)

    def test_the_map_is_on_the_surface(self):
        placement = self.placement
        n = len(placement.points)
        self.assertEqual(placement.triangles.max() + 1, n)
        self.assertAlmostEqual(placement.areas.sum(), 0.3 * 0.2)
        self.assertIn(placement.criterion, placement.maps)
        np.testing.assert_array_equal(placement.maps[placement.criterion], placement.score)
        self.assertEqual(len(placement.admissible), n)
        self.assertTrue(np.shares_memory(placement.score, placement.maps[placement.criterion]))

    def test_the_best_pair_is_on_the_highest_hill(self):
        best = self.placement.best[0]
        place = [best["x_m"], best["y_m"], best["z_m"]]
        self.assertGreaterEqual(best["score"], self.placement.score.max() * (1 - 1e-9))
        highest = self.placement.points[np.argmax(self.placement.score)]
        # By the symmetry of the plate there are four such places.
        np.testing.assert_allclose(abs(highest[:2]), abs(np.array(place[:2])), atol=0.03)

    def test_layouts_have_scores_and_deviations(self):
        names = [one["name"] for one in self.placement.layouts]
        self.assertEqual(set(names), set(self.placement.deviations))
        for layout in self.placement.layouts:
            deviation = self.placement.deviations[layout["name"]]
            self.assertAlmostEqual(100 * deviation.max(),
                                   layout["scores"]["interpolation_worst_place"], places=6)
        self.assertEqual(self.placement.optima[0]["criterion"], "determinant")

    def test_priors(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", chladni.ChladniWarning)
            priors = chladni.priors(self.modes)
        self.assertEqual(priors.kernel, "squared_exponential")
        self.assertTrue((priors.rms > 0).all())
        self.assertEqual(len(priors.matched_length), len(priors.rms))
        rows = priors.to_dict()["modes"]
        self.assertEqual(len(priors.modes), len(priors.rms))
        rigid = self.modes.rigid_body_modes
        self.assertEqual(list(priors.modes), [rigid + row["mode"] for row in rows])
        np.testing.assert_array_equal(self.modes.frequency_hz[priors.modes - 1],
                                      [row["frequency_hz"] for row in rows])


class Program(unittest.TestCase):
    """Python and the program say the same, to the last digit."""

    def test_modes_and_placement(self):
        whole = plate(placement={"modes": 3}, **channels())
        with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
            warnings.simplefilter("ignore", chladni.ChladniWarning)
            folder = pathlib.Path(name)
            modes = chladni.modes(whole)
            for verb, result in (("modes", modes), ("place", chladni.place(modes))):
                said, mine = said_by_program(verb, whole, folder), result.to_dict()
                self.assertEqual({key: said[key] for key in mine}, mine, verb)
                self.assertEqual(said["study"]["sha256"], result.study.sha256)


class Sweeps(unittest.TestCase):
    PLAN = """base = "base.toml"
verb = "modes"
[[axis]]
key = "geometry.plate.thickness"
values = ["8 mm", "10 mm", "12 mm"]
[[result]]
name = "first"
file = "modes.json"
at = "frequency_hz.6"
"""

    def test_a_thicker_plate_is_stiffer(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "base.toml").write_text(toml_text(plate(modes={"count": 3})))
            (folder / "plan.toml").write_text(self.PLAN)
            steps = []
            table = chladni.sweep(folder / "plan.toml", folder / "out",
                                  progress=lambda step, part: steps.append(part))
            self.assertEqual(chladni.gather(folder / "plan.toml", folder / "out"), table)
            first = [row["results"]["first"] for row in table["variants"]]
            self.assertEqual(first, sorted(first))
            np.testing.assert_allclose(first[2] / first[0], 12 / 8, rtol=0.02)
            self.assertEqual(steps[-1], 1.0)
            at_once = []
            chladni.sweep(folder / "plan.toml", folder / "out",
                          progress=lambda step, part: at_once.append(part))
            self.assertEqual(at_once[-1:], [1.0])  # however soon after the one before

    def test_what_stops_it_stops_it_at_once(self):
        def stop(step, part):
            calls.append(part)
            raise RuntimeError("enough")

        calls = []
        threads = chladni.thread_count()
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "base.toml").write_text(toml_text(plate(modes={"count": 3})))
            (folder / "plan.toml").write_text(self.PLAN)
            with self.assertRaisesRegex(RuntimeError, "enough"):
                chladni.sweep(folder / "plan.toml", folder / "out", jobs=1, progress=stop)
            self.assertEqual(len(calls), 1)
            left = list((folder / "out" / "variants").glob("*/variant.json"))
            self.assertEqual(len(left), 1)
        self.assertEqual(chladni.thread_count(), threads)

    def test_numbers_of_threads_and_jobs_are_checked(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "base.toml").write_text(toml_text(plate(modes={"count": 3})))
            (folder / "plan.toml").write_text(self.PLAN)
            for wrong in ({"threads": 0}, {"threads": -1}, {"jobs": -1}):
                with self.assertRaises(chladni.InvalidInput):
                    chladni.sweep(folder / "plan.toml", folder / "out", **wrong)


class Listeners(unittest.TestCase):
    def test_standard_error_may_be_missing_or_poor(self):
        class Poor:
            def write(self, text):
                return len(text)

        for stream in (None, Poor()):
            with unittest.mock.patch.object(sys, "stderr", stream):
                self.assertIsNone(_progress.listener(None))
                bar = _progress.listener(True)
                bar._start -= 10
                bar("meshing", 0.5)
                bar.close()


if __name__ == "__main__":
    unittest.main()
