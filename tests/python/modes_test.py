"""Modes, mesh and matrices of a study."""
import gc
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
import unittest.mock
import warnings

import chladni
import numpy as np
from studies import channels, patience, plate

try:
    import scipy.sparse
except ImportError:
    scipy = None


def solved(**more):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", chladni.ChladniWarning)
        return chladni.modes(plate(**more))


class Modes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.modes = solved(**channels())

    def test_are_those_of_a_thin_free_plate(self):
        # Leissa 1973, table C14: lambda = omega a^2 sqrt(rho h / D) of a free plate of 3:2 is 20.128,
        # 21.603, 46.654 for nu = 0.3; shear and rotation lower it by some per cent.
        stiffness = 70e9 * 0.01**3 / 12 / (1 - 0.3**2)
        unit = np.sqrt(stiffness / (2700 * 0.01)) / (2 * np.pi * 0.3**2)
        np.testing.assert_allclose(self.modes.frequency_hz[6:9] / unit, [20.128, 21.603, 46.654],
                                   rtol=0.04)
        modes = self.modes
        self.assertEqual(modes.rigid_body_modes, 6)
        self.assertTrue(modes.complete)
        self.assertTrue((modes.frequency_hz[:6] == 0).all())
        self.assertTrue((np.diff(modes.frequency_hz) >= 0).all())
        self.assertTrue((modes.residual < 1e-9).all())
        self.assertTrue((modes.damping_ratio[6:] == 0.005).all())
        self.assertAlmostEqual(modes.mass_kg, 1.62, places=9)
        np.testing.assert_allclose(modes.centre_m, [0, 0, -0.005], atol=1e-12)
        self.assertIn("counted", modes.summary)

    @unittest.skipIf(scipy is None, "SciPy is not installed")
    def test_satisfy_k_and_m(self):
        modes, K, M = self.modes, self.modes.K, self.modes.M
        self.assertIsInstance(K, scipy.sparse.csc_matrix)
        self.assertEqual(abs(K - K.T).max(), 0)
        self.assertEqual(abs(M - M.T).max(), 0)
        free = modes.free_dof
        self.assertEqual(len(free), modes.shapes.shape[0])
        phi = np.empty((K.shape[0], modes.shapes.shape[1]))
        phi[free] = modes.shapes
        np.testing.assert_allclose(phi.T @ (M @ phi), np.eye(phi.shape[1]), atol=1e-9)
        omega2 = (2 * np.pi * modes.frequency_hz) ** 2
        np.testing.assert_allclose(phi.T @ (K @ phi), np.diag(omega2), atol=1e-8 * omega2.max())
        # The mass of a rigid translation is that of the body.
        x = np.zeros(K.shape[0])
        x[free[0::3]] = 1.0
        self.assertAlmostEqual(x @ (M @ x), modes.mass_kg, places=9)
        self.assertLess(abs(K @ x).max(), 1e-6 * abs(K).max())

    def test_matrices_without_scipy_are_their_arrays(self):
        with unittest.mock.patch.dict(sys.modules, {"scipy.sparse": None}):
            K = self.modes.K
        self.assertIsInstance(K, chladni.Sparse)
        n = K.shape[0]
        columns = np.repeat(np.arange(n), np.diff(K.indptr))
        order = np.lexsort((columns, K.indices))
        np.testing.assert_array_equal(K.data, K.data[order])
        self.assertIsNone(self.modes.C)

    def test_what_attachments_add_has_rows_of_its_own(self):
        modes = solved(attachment=[{"kind": "resonator", "name": "q", "at": ["60 mm", "40 mm"],
                                    "mass": "40 g", "frequency": "300 Hz", "direction": "z"}])
        with unittest.mock.patch.dict(sys.modules, {"scipy.sparse": None}):
            M = modes.M
        self.assertEqual(modes.extra_shapes.shape, (1, modes.shapes.shape[1]))
        self.assertEqual(self.modes.extra_shapes.shape[0], 0)
        phi = np.zeros((M.shape[0], modes.shapes.shape[1]))
        phi[modes.free_dof] = np.vstack([modes.shapes, modes.extra_shapes])
        columns = np.repeat(np.arange(M.shape[0]), np.diff(M.indptr))
        moved = np.zeros_like(phi)
        np.add.at(moved, M.indices, M.data[:, None] * phi[columns])
        np.testing.assert_allclose(phi.T @ moved, np.eye(phi.shape[1]), atol=1e-9)

    def test_arrays_are_views_that_outlive_the_modes(self):
        modes = solved()
        shapes, nodes, f = modes.shapes, modes.mesh.nodes, modes.frequency_hz
        self.assertTrue(np.shares_memory(shapes, modes.shapes))
        self.assertTrue(np.shares_memory(modes.shape(7), shapes))
        self.assertFalse(shapes.flags.writeable)
        self.assertFalse(nodes.flags.owndata)
        copies = shapes.copy(), nodes.copy(), f.copy()
        del modes
        gc.collect()
        filler = [np.random.default_rng(1).random(shapes.shape) for _ in range(8)]
        for view, copy in zip((shapes, nodes, f), copies):
            np.testing.assert_array_equal(view, copy)
        del filler

    def test_mesh(self):
        mesh = self.modes.mesh
        self.assertEqual(mesh.order, 3)
        self.assertEqual(mesh.cells.shape[1], 20)
        self.assertEqual(mesh.faces.shape[1], 10)
        self.assertEqual(len(mesh.patch), len(mesh.faces))
        self.assertIn("top", mesh.patch_names)
        corners = mesh.nodes[mesh.cells[:, :4]]
        edges = corners[:, 1:] - corners[:, :1]
        self.assertAlmostEqual(np.linalg.det(edges).sum() / 6, 0.3 * 0.2 * 0.01, places=12)

    def test_shapes_at_nodes_are_those_of_the_nodes(self):
        modes, nodes = self.modes, self.modes.mesh.nodes
        top = np.flatnonzero(abs(nodes[:, 2]) < 1e-12)[:200]
        for axis, direction in enumerate(np.eye(3)):
            np.testing.assert_allclose(modes.at(nodes[top], direction),
                                       modes.shapes[3 * top + axis], atol=1e-9)
        each = np.tile([0.0, 0.0, 2.0], (len(top), 1))  # any length
        inside = (abs(nodes[top, 0]) < 0.149) & (abs(nodes[top, 1]) < 0.099)
        self.assertTrue(inside.any())
        np.testing.assert_allclose(modes.at(nodes[top], each)[inside],
                                   modes.at(nodes[top])[inside], atol=1e-9)

    def test_what_is_no_place_is_refused(self):
        with self.assertRaisesRegex(chladni.InvalidInput, r"point 1 at \(5000, 0, 0\) mm is"):
            self.modes.at([[0, 0, 0], [5, 0, 0]])
        with self.assertRaisesRegex(ValueError, "2 directions for 3 points"):
            self.modes.at(np.zeros((3, 3)), np.ones((2, 3)))
        with self.assertRaisesRegex(ValueError, "any length but 0"):
            self.modes.at(np.zeros((1, 3)), [0, 0, 0])

    def test_what_is_no_array_is_invalid_input(self):
        modes = self.modes
        for wrong, said in (([[0, 0]], r"has the shape \(1, 2\); expected n x 3 numbers"),
                            (np.zeros((1, 1, 3)), r"has the shape \(1, 1, 3\); expected n x 3"),
                            ([[0, 0, 1j]], "is complex; expected n x 3 numbers"),
                            ("here", "is 'here'; expected n x 3 numbers"),
                            ([[0, 0, 0], [0]], "is .*; expected n x 3 numbers")):
            with self.assertRaisesRegex(chladni.InvalidInput, "points " + said):
                modes.at(wrong)
        with self.assertRaisesRegex(chladni.InvalidInput, "direction is 'z'; expected n x 3"):
            modes.at([[0, 0, 0]], "z")
        space = modes.state_space()
        for asked in (modes.frf, space.frf):
            with self.assertRaisesRegex(chladni.InvalidInput, "frequency_hz is 100.0; expected n"):
                asked(100.0)
            for wrong in ([np.nan], [-5.0], [np.inf]):
                with self.assertRaisesRegex(chladni.InvalidInput,
                                            "frequency_hz has .*; expected 0 or more"):
                    asked(wrong)
        with self.assertRaisesRegex(chladni.InvalidInput, "frequency_hz has 200 after 300; expected"):
            modes.frf([300.0, 200.0])
        self.assertEqual(modes.frf([]).value.shape, (0, 7, 2))
        for seed in (-1, 2**32):
            with self.assertRaisesRegex(chladni.InvalidInput, f"seed is {seed}; expected"):
                chladni.modes(plate(), seed=seed)
        self.assertEqual(chladni.modes(plate(), seed=np.int64(3), progress=False).rigid_body_modes, 6)

    def test_a_state_space_that_cannot_be_meant_is_refused(self):
        nan, inf = np.nan, np.inf
        for name, values in {"sample_rate_hz": (-20000, nan, inf, -inf), "states": (-4,),
                             "pade_order": (-3,)}.items():
            for value in values:
                for asked in (self.modes.state_space, self.modes.to_control):
                    with self.assertRaisesRegex(chladni.InvalidInput, f"{name} is {value}; expected"):
                        asked(**{name: value})

    def test_ctrl_c_stops_a_state_space(self):
        space = self.modes.state_space()
        lines = np.linspace(10, 4000, 400000)
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            space.frf(lines)
            time.sleep(60)
        self.assertLess(time.monotonic() - start, 1.0 * patience())

    def test_responses_are_the_modal_sum_and_the_state_space(self):
        modes = self.modes
        f = np.array([20.0, 333.0, 1000.0])
        frf = modes.frf(f)
        self.assertEqual(frf.value.shape, (3, 7, 2))
        self.assertEqual([one.name for one in frf.outputs][:2], ["s1", "s2"])
        self.assertEqual(frf.inputs[0].unit, "N")
        np.testing.assert_allclose(frf.outputs[0].position[:2], [-0.14, 0.09], atol=1e-12)
        space = modes.state_space()
        np.testing.assert_allclose(space.frf(f), frf.value, rtol=1e-8)
        points = [one.position for one in frf.outputs]
        shapes = modes.at(points, [0, 0, 1])
        omega, s = 2 * np.pi * modes.frequency_hz, 2j * np.pi * f
        dynamic = s[:, None] ** 2 + 2 * modes.damping_ratio * omega * s[:, None] + omega ** 2
        total = np.einsum("im,jm,km->kij", shapes, shapes[[0, 2]], 1 / dynamic)
        static = frf.value - total  # of the modes above: real, the same at all frequencies
        np.testing.assert_allclose(static, np.broadcast_to(static[0].real, static.shape),
                                   atol=1e-6 * abs(frf.value).max())
        # Reciprocity: s3 by a1 (at s1) is s1 by a2 (at s3).
        np.testing.assert_allclose(frf.value[:, 2, 0], frf.value[:, 0, 1], rtol=1e-9)

    def test_state_space_goes_to_other_packages(self):
        discrete = self.modes.state_space(sample_rate_hz=20000)
        self.assertAlmostEqual(discrete.sample_time_s, 5e-5)
        a, b, c, d, dt = (0, 0, 0, 0, 0)
        try:
            import control
            made = self.modes.to_control(sample_rate_hz=20000)
            self.assertIsInstance(made, control.StateSpace)
        except ImportError:
            a, b, c, d, dt = self.modes.to_control(sample_rate_hz=20000)
            self.assertEqual(dt, discrete.sample_time_s)
            np.testing.assert_array_equal(a, discrete.A)
            self.assertEqual((b.shape[1], c.shape[0], d.shape), (2, 7, (7, 2)))
        self.assertEqual(discrete.inputs, ["a1", "a2"])
        self.assertEqual(set(discrete.output_units), {"m"})

    def test_the_files_of_the_verb(self):
        with tempfile.TemporaryDirectory() as folder:
            self.modes.save(folder, pictures=False)
            left = json.loads((pathlib.Path(folder) / "modes.json").read_text())
            self.assertEqual({key: left[key] for key in self.modes.to_dict()}, self.modes.to_dict())
            self.assertTrue((pathlib.Path(folder) / "modes.vtu").exists())
            self.modes.save_page(pathlib.Path(folder) / "page.html")
            self.assertIn("</html>", (pathlib.Path(folder) / "page.html").read_text())

    def test_a_notebook_shows_the_viewer(self):
        page = self.modes._repr_html_()
        self.assertTrue(page.startswith("<iframe srcdoc="))
        self.assertIn("sandbox", page)
        self.assertIn("&lt;script", page)
        self.assertNotIn("<script", page)  # it stays inside the frame
        self.assertIn("Hz", str(self.modes))
        self.assertIn("plate", repr(self.modes))

    def test_missing_packages_are_named(self):
        for package, call in (("pandas", self.modes.to_pandas), ("pyvista", self.modes.to_pyvista)):
            with unittest.mock.patch.dict(sys.modules, {package: None}):
                with self.assertRaisesRegex(ImportError, f"needs the package {package}"):
                    call()

    def test_what_other_packages_are_given(self):
        # Stand-ins that keep what they get: the real packages are rarely installed.
        class Kept:
            def __init__(self, *values, **more):
                self.values, self.more, self.point_data = values, more, {}
        module = types.SimpleNamespace(UnstructuredGrid=Kept, PolyData=Kept, ss=Kept)
        modes = self.modes
        with unittest.mock.patch.dict(sys.modules, {"pyvista": module, "control": module}):
            grid = modes.to_pyvista()
            surface = chladni.place(modes).to_pyvista()
            loop = modes.to_control(sample_rate_hz=20000)
        cells, kinds, points = grid.values
        cells = cells.reshape(len(kinds), -1)
        self.assertTrue((kinds == 71).all() and (cells[:, 0] == 20).all())  # VTK's Lagrange tetrahedra
        np.testing.assert_array_equal(cells[:, 1:], modes.mesh.cells)
        np.testing.assert_array_equal(points, modes.mesh.nodes)
        name = f"mode_008_{modes.frequency_hz[7]:.2f}Hz"
        np.testing.assert_array_equal(grid.point_data[name].ravel(), modes.shapes[:, 7])
        self.assertEqual(surface.values[1].reshape(-1, 4)[:, 1:].max() + 1, len(surface.values[0]))
        self.assertIn("weakest_mode", surface.point_data)
        self.assertEqual(len(loop.values), 5)
        self.assertEqual(loop.more["inputs"], ["a1", "a2"])
        self.assertEqual(len(loop.more["states"]), len(loop.values[0]))

    def test_a_table_goes_to_pandas(self):
        self.assertEqual(len(self.modes.table), len(self.modes.frequency_hz))
        self.assertEqual(self.modes.table[7]["frequency_hz"], self.modes.frequency_hz[7])

    def test_the_same_study_gives_the_same_bits(self):
        again = solved(**channels())
        np.testing.assert_array_equal(again.shapes, self.modes.shapes)


class Progress(unittest.TestCase):
    def test_is_told(self):
        steps = []
        solved_with(lambda step, part: steps.append((step, part)))
        self.assertGreater(len({step for step, _ in steps}), 2)
        for step, part in steps:
            self.assertIsInstance(step, str)
            self.assertTrue(part is None or 0 <= part <= 1)

    def test_an_exception_in_it_ends_the_step_and_is_raised(self):
        def impatient(step, part):
            raise LookupError(f"enough at {step}")
        with self.assertRaisesRegex(LookupError, "enough at "):
            solved_with(impatient)

    def test_what_cannot_be_told_is_refused(self):
        with self.assertRaisesRegex(TypeError, "expected a function"):
            solved_with(3)

    def test_the_bar(self):
        import io
        stream = io.StringIO()
        bar = chladni.Bar(stream)
        bar("meshing", 0.1)
        self.assertEqual(stream.getvalue(), "")  # quiet at first
        bar._start -= 7
        bar("meshing", 0.5)
        self.assertIn("meshing [############............]  50 % 7 s", stream.getvalue())
        bar("factorise", None)
        bar.close()
        self.assertTrue(stream.getvalue().endswith("\r"))
        self.assertEqual(stream.getvalue().split("\r")[-2].strip(), "")


def solved_with(progress):
    return chladni.modes(plate(), progress=progress)


class Machine(unittest.TestCase):
    PROGRAM = """
import ctypes, sys
sys.path.insert(0, {tests!r})
import chladni
from studies import plate
blas = ctypes.CDLL("libopenblas.so.0")
blas.openblas_set_num_threads(2)
threads = chladni.thread_count()
chladni.modes(plate(), progress=False)
print(blas.openblas_get_num_threads(), chladni.thread_count() == threads)
chladni.set_thread_count(1)
print(chladni.thread_count())
"""

    def test_threads_are_as_before(self):
        done = subprocess.run(
            [sys.executable, "-c", self.PROGRAM.format(tests=str(pathlib.Path(__file__).parent))],
            capture_output=True, text=True, check=False)
        self.assertEqual(done.stdout.split(), ["2", "True", "1"], done.stderr)

    def test_errors_have_their_kinds(self):
        self.assertTrue(issubclass(chladni.InvalidInput, ValueError))
        self.assertTrue(issubclass(chladni.NumericalFailure, RuntimeError))
        self.assertTrue(issubclass(chladni.WorkerDied, chladni.NumericalFailure))
        self.assertTrue(issubclass(chladni.OutOfResources, chladni.NumericalFailure))
        self.assertTrue(issubclass(chladni.OutOfResources, MemoryError))
        self.assertTrue(issubclass(chladni.ChladniWarning, UserWarning))
        with self.assertRaises(MemoryError):
            chladni.modes(plate(mesh={"edge_length": "10 mm"}), memory_limit_gb=1e-3)
        with self.assertRaisesRegex(ValueError, "count"):
            chladni.set_thread_count(0)

    def test_version_has_the_commit(self):
        self.assertRegex(chladni.__version__, r"^\d+\.\d+\.\d+\+\S+$")


class Warnings(unittest.TestCase):
    def test_are_those_of_python(self):
        away = plate(sensor=[{"name": "s", "at": ["0 mm", "0 mm", "-5 mm"], "direction": "z"}])
        with self.assertWarnsRegex(chladni.ChladniWarning, "s"):
            modes = chladni.modes(away)
        self.assertTrue(modes.warnings)
        with warnings.catch_warnings():
            warnings.simplefilter("error", chladni.ChladniWarning)
            with self.assertRaises(chladni.ChladniWarning):
                chladni.modes(away)


if __name__ == "__main__":
    unittest.main()
