"""Files of measured data, from arrays and back."""
import pathlib
import tempfile
import threading
import time
import unittest

import chladni
import numpy as np

LINES, OUTPUTS, INPUTS = 17, 3, 2


def responses(seed=3, quantity="displacement", unit="m"):
    draw = np.random.default_rng(seed)
    value = draw.standard_normal((LINES, OUTPUTS, INPUTS, 2)) @ [1, 1j]
    outputs = [chladni.Channel(f"y{i}", quantity, unit, position=[0.1 * i, 0.2, 0.0],
                               direction=[0, 0, 1], node=100 + i) for i in range(OUTPUTS)]
    inputs = [chladni.Channel(f"u{j}", unit="N", position=[0, 0.3 * j, 0], direction=[0, 0, -1],
                              node=200 + j) for j in range(INPUTS)]
    return chladni.Frf(np.linspace(10, 500, LINES), value, outputs, inputs,
                       variance=draw.uniform(0.1, 1, value.shape))


class Responses(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def test_are_read_back_from_every_format(self):
        frf = responses()
        for name in ("measured.csv", "measured.uff", "measured.unv", "measured.mat"):
            with self.subTest(name):
                chladni.write_frf(self.folder / name, frf)
                more = {"unit": "m"} if name.endswith("csv") else {}
                again = chladni.read_frf(self.folder / name, **more)
                np.testing.assert_array_equal(again.frequency_hz, frf.frequency_hz)
                np.testing.assert_allclose(again.value, frf.value, rtol=1e-15)
                if again.variance is not None:
                    np.testing.assert_allclose(again.variance, frf.variance, rtol=1e-15)
                self.assertEqual(again.format.split()[0],
                                 {"csv": "CSV", "mat": "MAT"}.get(name[-3:], "UFF"))

    def test_csv_and_mat_keep_names_and_variances(self):
        frf = responses()
        for name in ("measured.csv", "measured.mat"):
            chladni.write_frf(self.folder / name, frf)
            again = chladni.read_frf(self.folder / name, sensors=["y0", "y1", "y2"],
                                     actuators=["u0", "u1"])
            self.assertEqual([c.name for c in again.outputs], ["y0", "y1", "y2"])
            self.assertEqual([c.name for c in again.inputs], ["u0", "u1"])
            self.assertIsNotNone(again.variance)

    def test_universal_files_keep_nodes_and_units(self):
        chladni.write_frf(self.folder / "measured.uff", responses(quantity="acceleration",
                                                                  unit="m/s^2"))
        again = chladni.read_frf(self.folder / "measured.uff")
        self.assertEqual([c.node for c in again.outputs], [100, 101, 102])
        self.assertEqual(again.outputs[0].quantity, "acceleration")
        self.assertEqual(again.outputs[0].unit, "m/s^2")
        np.testing.assert_allclose(again.outputs[2].position, [0.2, 0.2, 0.0], atol=1e-12)
        np.testing.assert_allclose(again.inputs[1].direction, [0, 0, -1])

    def test_nan_is_not_measured(self):
        frf = responses()
        value = frf.value
        value[:, 1, 0] = np.nan
        part = chladni.Frf(frf.frequency_hz, value, frf.outputs, frf.inputs)
        chladni.write_frf(self.folder / "part.csv", part)
        again = chladni.read_frf(self.folder / "part.csv")
        np.testing.assert_array_equal(np.isnan(again.value), np.isnan(value))
        self.assertIsNone(again.variance)

    def test_nothing_is_written_over_unasked(self):
        file = self.folder / "measured.csv"
        chladni.write_frf(file, responses(1))
        with self.assertRaisesRegex(chladni.InvalidInput, "overwrite=True"):
            chladni.write_frf(file, responses(2))
        chladni.write_frf(file, responses(2), overwrite=True)
        np.testing.assert_array_equal(chladni.read_frf(file).value, responses(2).value)

    def test_an_acceleration_is_a_displacement_twice_derived(self):
        frf = responses()
        omega = 2 * np.pi * frf.frequency_hz[:, None, None]
        moved = frf.converted("acceleration")
        np.testing.assert_allclose(moved.value, -omega ** 2 * frf.value, rtol=1e-12)
        np.testing.assert_allclose(moved.variance, omega ** 4 * frf.variance, rtol=1e-12)
        self.assertEqual(moved.outputs[0].quantity, "acceleration")
        np.testing.assert_allclose(moved.converted("displacement").value, frf.value, rtol=1e-12)

    def test_a_line_at_rest_that_cannot_be_integrated_is_told(self):
        at_rest = chladni.Frf([0, 10, 20], np.ones((3, 1, 1), complex),
                              [chladni.Channel("y", "acceleration", "m/s^2")], ["u"])
        moved = at_rest.converted("displacement")
        np.testing.assert_array_equal(moved.frequency_hz, [10, 20])
        self.assertEqual(moved.notes, ["the line at 0 Hz is left out: it cannot be integrated"])
        self.assertEqual(at_rest.notes, [])
        self.assertEqual(at_rest.converted("acceleration").notes, [])
        self.assertEqual(len(at_rest.converted("acceleration").frequency_hz), 3)

    def test_si_is_of_what_each_channel_is_said_to_measure(self):
        quantities = ("displacement", "velocity", "acceleration")
        stated = [chladni.Channel(one[0], one) for one in quantities]
        frf = chladni.Frf([10, 20], np.ones((2, 3, 1), complex), stated, ["u1"])
        for name in ("mixed.uff", "mixed.mat"):
            chladni.write_frf(self.folder / name, frf)
            again = chladni.read_frf(self.folder / name, unit="SI")
            self.assertEqual([one.quantity for one in again.outputs], list(quantities), name)
            self.assertEqual([one.unit for one in again.outputs], ["m", "m/s", "m/s^2"], name)

    def test_si_of_a_channel_that_nothing_tells_of_is_refused(self):
        file = self.folder / "partly.csv"
        file.write_text("freq_hz,re_y1/u1 [m/s],im_y1/u1 [m/s],re_y2/u1,im_y2/u1\n10,1,2,3,4\n")
        with self.assertRaisesRegex(chladni.InvalidInput, 'partly.csv: unit="SI".* "y2" measures'):
            chladni.read_frf(file, unit="SI")
        known = chladni.read_frf(file, unit="m/s^2")
        self.assertEqual([one.quantity for one in known.outputs], ["velocity", "acceleration"])
        whole = self.folder / "whole.csv"
        whole.write_text("freq_hz,re_y2/u1,im_y2/u1\n10,1,2\n")
        said = chladni.read_frf(whole, unit="SI", quantity="velocity").outputs[0]
        self.assertEqual((said.quantity, said.unit), ("velocity", "m/s"))
        recorded = self.folder / "recorded.csv"
        recorded.write_text("time_s,y1,u1\n0,1,2\n0.1,3,4\n0.2,5,6\n")
        with self.assertRaisesRegex(chladni.InvalidInput, 'unit="SI".* "y1" measures'):
            chladni.read_time(recorded, unit="SI")

    def test_parts(self):
        frf = responses()
        part = frf.part(outputs=["y2", "y0"]).band(100, 300)
        inside = (frf.frequency_hz >= 100) & (frf.frequency_hz <= 300)
        np.testing.assert_array_equal(part.value, frf.value[inside][:, [2, 0]])
        with self.assertRaisesRegex(ValueError, 'no channel "y7"'):
            frf.part(outputs=["y7"])
        with self.assertRaisesRegex(chladni.InvalidInput, "there is no output"):
            frf.part(outputs=[])
        with self.assertRaisesRegex(chladni.InvalidInput, 'two outputs are called "y0"'):
            frf.part(outputs=["y0", "y0"])
        for low, high in ((np.nan, np.nan), (np.nan, 300), (100, np.nan), (300, 100)):
            with self.assertRaisesRegex(chladni.InvalidInput, "the lower one first"):
                frf.band(low, high)
        self.assertEqual(len(frf.band(-np.inf, np.inf).frequency_hz), LINES)

    def test_no_lines_are_an_empty_array(self):
        frf = chladni.Frf([], np.zeros((0, 2, 1), complex), ["y", "z"], ["u"])
        self.assertEqual((frf.value.shape, frf.value.dtype), ((0, 2, 1), complex))
        self.assertIsNone(frf.variance)

    def test_channels_are_any_sequence_of_names(self):
        value = np.ones((2, 2, 1), complex)
        for names in (("y", "z"), np.array(["y", "z"]), [chladni.Channel("y"), "z"],
                      {"y": 1, "z": 2}.keys()):
            frf = chladni.Frf([1, 2], value, names, ("u",))
            self.assertEqual([one.name for one in frf.outputs], ["y", "z"])
        self.assertEqual(frf.part(np.array(["z"]), ("u",)).outputs[0].name, "z")

    def test_what_is_no_channel_is_named(self):
        value = np.ones((2, 1, 1), complex)
        with self.assertRaisesRegex(chladni.InvalidInput, "outputs has 1; expected a Channel or a"):
            chladni.Frf([1, 2], value, [1], ["u"])
        with self.assertRaisesRegex(chladni.InvalidInput, "inputs has None; expected a Channel or a"):
            chladni.Frf([1, 2], value, ["y"], [None])
        with self.assertRaisesRegex(chladni.InvalidInput, "inputs is 'u'; expected a list of"):
            chladni.Frf([1, 2], value, ["y"], "u")
        with self.assertRaisesRegex(chladni.InvalidInput, "outputs is 3; expected a list of"):
            chladni.Frf([1, 2], value, 3, ["u"])
        with self.assertRaisesRegex(chladni.InvalidInput, "outputs has .*ud800.*; expected"):
            chladni.Frf([1, 2], value, ["\ud800"], ["u"])

    def test_what_is_no_array_is_named_with_its_shape(self):
        value = np.ones((2, 1, 1), complex)
        with self.assertRaisesRegex(chladni.InvalidInput,
                                    r"frequency_hz has the shape \(2, 2\); expected n numbers"):
            chladni.Frf([[1, 2], [3, 4]], value, ["y"], ["u"])
        with self.assertRaisesRegex(chladni.InvalidInput, "frequency_hz is 'x'; expected n numbers"):
            chladni.Frf("x", value, ["y"], ["u"])
        with self.assertRaisesRegex(chladni.InvalidInput, "frequency_hz is complex; expected"):
            chladni.Frf([1 + 1j, 2], value, ["y"], ["u"])
        with self.assertRaisesRegex(chladni.InvalidInput, "variance is complex; expected"):
            chladni.Frf([1, 2], value, ["y"], ["u"], variance=value)
        with self.assertRaisesRegex(chladni.InvalidInput, "coherence is 'x'; expected"):
            chladni.Frf([1, 2], value, ["y"], ["u"], coherence="x")
        with self.assertRaisesRegex(chladni.InvalidInput,
                                    r"position has the shape \(2,\); expected 3 numbers"):
            chladni.Channel("y", position=[0, 1])

    def test_what_does_not_fit_is_refused(self):
        f = [1.0, 2.0]
        with self.assertRaisesRegex(ValueError, "lines x outputs x inputs"):
            chladni.Frf(f, np.zeros((2, 2)), ["y"], ["u"])
        with self.assertRaisesRegex(ValueError, "ascending"):
            chladni.Frf([2.0, 1.0], np.zeros((2, 1, 1)), ["y"], ["u"])
        with self.assertRaisesRegex(ValueError, "two output"):
            chladni.Frf(f, np.zeros((2, 2, 1)), ["y", "y"], ["u"])
        with self.assertRaisesRegex(ValueError, "without a phase"):  # magnitudes
            chladni.Frf(f, np.ones((2, 1, 1)), ["y"], ["u"])
        self.assertEqual(chladni.Frf(f, [[[1 + 0j]], [[2 + 0j]]], ["y"], ["u"]).value[1, 0, 0], 2)
        with self.assertRaisesRegex(ValueError, "there_is_none.csv"):
            chladni.read_frf(self.folder / "there_is_none.csv")
        with self.assertRaisesRegex(ValueError, "expected displacement, velocity or acceleration"):
            chladni.Channel("y", "speed")
        for unit in ("mm", "g", "mg", "[mm]", "kN", "LBF"):  # values beside a unit are in SI
            with self.assertRaisesRegex(ValueError, "is not SI"):
                chladni.Channel("y", unit=unit)
        with self.assertRaisesRegex(ValueError, 'expected quantity="acceleration"'):
            chladni.Channel("y", unit="m/s^2")
        self.assertEqual(chladni.Channel("y", "acceleration", "m/s^2").unit, "m/s^2")
        self.assertEqual(chladni.Channel("u", unit="V").unit, "V")
        for unit in ("um/N", "um N^-1", "g/lbf", "m/s^2/kN"):  # values of responses, too
            with self.assertRaisesRegex(ValueError, "is not SI; give values in m.*/N"):
                chladni.Channel("y", unit=unit)
        self.assertEqual(chladni.Channel("y", unit="m/N").unit, "m/N")
        broken = self.folder / "broken.csv"
        broken.write_text("freq_hz,re_yu,im_yu\n1,2,x\n")
        with self.assertRaisesRegex(ValueError, r"broken\.csv.*line 2"):
            chladni.read_frf(broken)


class TimeData(unittest.TestCase):
    TEXT = ("time_s,period,in_u,out_y\n" +
            "".join(f"{n / 64},{n // 64},{np.sin(2 * np.pi * 5 * n / 64) + (n % 64 == 0)},"
                    f"{3 * (np.sin(2 * np.pi * 5 * n / 64) + (n % 64 == 0))}\n" for n in range(256)))

    def test_recordings_are_read_written_and_estimated(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "time.csv"
            file.write_text(self.TEXT)
            recordings = chladni.read_time(file)
            self.assertAlmostEqual(recordings.sample_time_s, 1 / 64)
            self.assertEqual([c.name for c in recordings.outputs], ["y"])
            outputs = np.concatenate([one.outputs for one in recordings.records])
            inputs = np.concatenate([one.inputs for one in recordings.records])
            np.testing.assert_allclose(outputs, 3 * inputs, rtol=1e-12)
            frf = recordings.frf(low_hz=1, high_hz=30, inputs="forces")
            np.testing.assert_allclose(frf.value, 3, rtol=1e-9)
            chladni.write_time(pathlib.Path(folder) / "again.csv", recordings)
            again = chladni.read_time(pathlib.Path(folder) / "again.csv")
            np.testing.assert_array_equal(
                np.concatenate([one.outputs for one in again.records]), outputs)

    def test_the_hold_of_commands_is_taken_off(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "time.csv"
            file.write_text(self.TEXT)
            recordings = chladni.read_time(file)
        kept = recordings.frf(1, 30, inputs="forces")
        freed = recordings.frf(1, 30)
        # A hold delays by half a sample and shrinks by sin x / x, x = omega T / 2.
        x = np.pi * freed.frequency_hz[:, None, None] / 64
        np.testing.assert_allclose(freed.value, kept.value * x / np.sin(x) * np.exp(1j * x),
                                   rtol=1e-9)
        if kept.variance is not None:
            np.testing.assert_allclose(freed.variance, kept.variance * (x / np.sin(x)) ** 2,
                                       rtol=1e-9)
        np.testing.assert_array_equal(recordings.frf(1, 30, inputs="commands").value, freed.value)
        self.assertTrue(any("hold" in note for note in freed.notes))
        self.assertFalse(any("hold" in note for note in kept.notes))
        with self.assertRaisesRegex(chladni.InvalidInput, 'inputs is "force"; expected "commands"'):
            recordings.frf(1, 30, inputs="force")
        for band in ((np.nan, 30), (1, np.nan), (30, 1)):
            with self.assertRaisesRegex(chladni.InvalidInput, "the lower one first"):
                recordings.frf(*band)


class Shapes(unittest.TestCase):
    def test_mac(self):
        draw = np.random.default_rng(5)
        a = draw.standard_normal((6, 3)) + 1j * draw.standard_normal((6, 3))
        np.testing.assert_allclose(np.diag(chladni.mac(a, a * (2 - 3j))), 1)
        b = draw.standard_normal((6, 2))
        by_hand = abs(a.conj().T @ b) ** 2 / np.outer((abs(a) ** 2).sum(0), (b ** 2).sum(0))
        np.testing.assert_allclose(chladni.mac(a, b), by_hand)
        np.testing.assert_allclose(chladni.mac(a.real, b), chladni.mac(a.real + 0j, b + 0j))

    def test_what_is_no_shape_is_named(self):
        with self.assertRaisesRegex(chladni.InvalidInput, r"b has the shape \(2, 2, 2\); expected"):
            chladni.mac(np.eye(2), np.ones((2, 2, 2)))
        with self.assertRaisesRegex(chladni.InvalidInput, "a is 'x'; expected"):
            chladni.mac("x", np.eye(2))

    def test_real_shapes_cost_real_products_and_let_others_run(self):
        draw = np.random.default_rng(5)
        shapes = draw.standard_normal((2000, 600))
        ticks, stop = [], threading.Event()

        def tick():
            while not stop.wait(1e-3):
                ticks.append(time.perf_counter())

        def taken(given):
            """Seconds, and the part of them that another thread waited at a stretch."""
            start = time.perf_counter()
            chladni.mac(given, given)
            end = time.perf_counter()
            heard = [start] + [one for one in list(ticks) if start < one < end] + [end]
            return end - start, max(np.diff(heard)) / (end - start)

        other = threading.Thread(target=tick, daemon=True)
        other.start()
        real = [taken(shapes) for _ in range(3)]
        full = [taken(shapes + 0j) for _ in range(3)]
        stop.set()
        other.join()
        self.assertLess(min(part for _, part in real + full), 0.5, "the lock was held")
        self.assertLess(min(real)[0], 0.7 * min(full)[0], (real, full))


if __name__ == "__main__":
    unittest.main()
