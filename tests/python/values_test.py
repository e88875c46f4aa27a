"""What objects are as values: equality, copies, pickles, and none that is empty."""
import copy
import pickle
import subprocess
import sys
import unittest
import warnings

import chladni
import numpy as np
from studies import channels, plate


def cause(place, share=0.5):
    return chladni.Cause("point_mass", {"mass": chladni.Quantity(0.04, 1e-3, "kg")}, place, ["s1"],
                         None, 0.9, 12.0, share)


def sparse(numbers=(1.0, 2.0)):
    return chladni.Sparse(np.array(numbers), np.array([0, 1]), np.array([0, 1, 2]), (2, 2))


def copies(one):
    return copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))


class Texts(unittest.TestCase):
    def test_a_deviation_that_is_not_known_is_called_so(self):
        self.assertEqual(str(chladni.Quantity(0.04, 1e-3, "kg")), "0.04 +- 0.001 kg")
        for unknown in (None, np.inf, np.nan):
            self.assertEqual(str(chladni.Quantity(0.04, unknown, "1")), "0.04 +- unknown")


class Equality(unittest.TestCase):
    def test_arrays_are_compared_as_a_whole(self):
        self.assertEqual(cause(np.zeros(3)), cause(np.zeros(3)))
        self.assertEqual(cause(None), cause(None))
        self.assertNotEqual(cause(np.zeros(3)), cause(np.ones(3)))
        self.assertNotEqual(cause(np.zeros(3)), cause(None))
        self.assertNotEqual(cause(None), cause(np.zeros(3)))
        self.assertNotEqual(cause(np.zeros(3)), cause(np.zeros(3), share=0.4))
        self.assertEqual(sparse(), sparse())
        self.assertNotEqual(sparse(), sparse((1.0, 3.0)))
        self.assertNotEqual(sparse(), sparse((1.0,)))
        self.assertNotEqual(sparse(), "sparse")

    def test_what_is_equal_has_one_hash(self):
        self.assertEqual(len({cause(np.zeros(3)), cause(np.zeros(3)), cause(np.ones(3))}), 2)
        self.assertEqual(hash(cause(np.array([0.0]))), hash(cause(np.array([-0.0]))))
        self.assertEqual(len({sparse(), sparse(), sparse((1.0, 3.0))}), 2)


class Copies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", chladni.ChladniWarning)
        cls.modes = chladni.modes(plate(**channels()), progress=False)

    def test_of_responses(self):
        outputs = [chladni.Channel("y", "acceleration", "m/s^2", [0.1, 0.2, 0.3], [0, 1, 0], 7), "z"]
        value = np.arange(12.0).reshape(3, 2, 2) * (1 + 2j)
        value[1, 0, 0] = np.nan
        frf = chladni.Frf([1, 2, 4], value, outputs, ["u", "v"], variance=abs(value),
                          coherence=np.full(value.shape, 0.5), averages=3)
        for again in copies(frf):
            for name in ("frequency_hz", "value", "variance", "coherence"):
                np.testing.assert_array_equal(getattr(again, name), getattr(frf, name))
            for name in ("averages", "format", "notes"):
                self.assertEqual(getattr(again, name), getattr(frf, name))
            self.assertEqual([str(one) for one in again.outputs + again.inputs],
                             [str(one) for one in frf.outputs + frf.inputs])
        plain = chladni.Frf([], np.zeros((0, 1, 1), complex), ["y"], ["u"])
        for again in copies(plain):
            self.assertEqual(again.value.shape, (0, 1, 1))
            self.assertIsNone(again.variance)

    def test_of_channels(self):
        for one in (chladni.Channel("y", "velocity", "m/s", [0.1, 0.2, 0.3], [0, 1, 0], 7),
                    chladni.Channel("u")):
            for again in copies(one):
                for name in ("name", "quantity", "unit", "node"):
                    self.assertEqual(getattr(again, name), getattr(one, name))
                np.testing.assert_array_equal(again.position, one.position)
                np.testing.assert_array_equal(again.direction, one.direction)

    def test_of_state_spaces(self):
        for one in (self.modes.state_space(), self.modes.state_space(sample_rate_hz=20000)):
            for again in copies(one):
                for name in ("A", "B", "C", "D", "input_delay", "output_delay"):
                    np.testing.assert_array_equal(getattr(again, name), getattr(one, name))
                for name in ("sample_time_s", "states", "inputs", "outputs", "state_units",
                             "input_units", "output_units"):
                    self.assertEqual(getattr(again, name), getattr(one, name))
                np.testing.assert_array_equal(again.frf([100.0]), one.frf([100.0]))

    def test_a_pickle_with_other_content_is_refused(self):
        make, state = chladni.Channel("y").__reduce__()
        with self.assertRaisesRegex(chladni.InvalidInput, "a copy has 5 parts; expected 6"):
            make(*state[:-1])
        with self.assertRaisesRegex(chladni.InvalidInput, "has the quantity 7; expected 0 to 2"):
            make(*state[:-1], 7)
        make, state = chladni.Frf([1], [[[1j]]], ["y"], ["u"]).__reduce__()
        with self.assertRaises(chladni.InvalidInput):
            make(*(np.zeros((2, 1, 1)) if np.shape(one) == (1, 1, 1) else one for one in state))

    def test_of_results_are_the_results(self):  # nothing in them changes
        self.assertIs(copy.copy(self.modes), self.modes)
        self.assertIs(copy.deepcopy([self.modes])[0], self.modes)
        study = chladni.Study(plate())
        self.assertIs(copy.deepcopy(study), study)
        for one in (self.modes, study, chladni.PlacementPlan()):
            for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
                with self.assertRaisesRegex(TypeError, "cannot pickle"):
                    pickle.dumps(one, protocol)


class Empty(unittest.TestCase):
    def test_objects_are_not_made_from_python(self):
        for name in ("Modes", "Result", "StateSpace", "Mesh", "Diagnosis", "Recordings"):
            program = f"import chladni\nprint(chladni.{name}.__new__(chladni.{name}))"
            done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                                  check=False)
            self.assertEqual(done.returncode, 1, f"{name}: {done}")
            self.assertIn("TypeError", done.stderr)
            with self.assertRaisesRegex(TypeError, f"{name}: No constructor"):
                getattr(chladni, name)()


if __name__ == "__main__":
    unittest.main()
