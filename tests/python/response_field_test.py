"""Responses between the sensors on arrays: a pinned beam, whose modes are sines."""
import unittest

import chladni
import numpy as np

LENGTH = 1.5
ORDER = np.arange(1, 11)
SENSORS = np.array([0.11, 0.27, 0.4, 0.58, 0.71, 0.93, 1.07, 1.22, 1.41])
ACTUATORS = np.array([0.27, 1.07])
BETWEEN = np.array([0.19, 0.65, 1.31])


def shapes(x):
    return np.sin(np.outer(x, ORDER) * np.pi / LENGTH)


def places(x):
    position = np.column_stack([x, np.zeros((len(x), 2))])
    return chladni.Places(position, np.tile([0.0, 0.0, 1.0], (len(x), 1)), shapes(x))


def truth(x, frequency_hz):
    """Four modes: what modes above the band leave is no part of the stated deviation."""
    omega = 2 * np.pi * frequency_hz[:, None]
    natural = 2 * np.pi * 20.0 * ORDER[:4] ** 2
    modal = 1.0 / (natural ** 2 - omega ** 2 + 0.02j * natural * omega)
    return np.einsum("km,im,jm->kij", modal, shapes(x)[:, :4], shapes(ACTUATORS)[:, :4])


def simulation():
    x = np.linspace(0.0, LENGTH, 121)
    return chladni.Simulation(20.6 * ORDER ** 2.0, places(x), np.full(121, LENGTH / 121))


def field():
    lines = np.linspace(10.0, 400.0, 1561)
    responses = truth(SENSORS, lines)
    random = np.random.default_rng(3)
    responses = responses + 7.07e-8 * (random.normal(size=responses.shape) +
                                         1j * random.normal(size=responses.shape))
    return chladni.response_field(lines, responses, places(SENSORS), places(ACTUATORS),
                                  simulation(), variance=np.full(responses.shape, 1e-14))


class ResponseField(unittest.TestCase):
    def test_it_is_the_beam_between_the_sensors(self):
        found = field()
        np.testing.assert_allclose(found.frequency_hz, 20.0 * ORDER[:4] ** 2, rtol=1e-4)
        np.testing.assert_allclose(found.damping_ratio, 0.01, rtol=0.02)
        lines = np.linspace(10.0, 400.0, 391)
        value, deviation = found.at(places(BETWEEN), lines)
        self.assertEqual(value.shape, (391, 3, 2))
        real = truth(BETWEEN, lines)
        error = np.linalg.norm(value - real)
        self.assertLess(error, 0.02 * np.linalg.norm(real))
        self.assertLess(error, 3.0 * np.linalg.norm(deviation))

    def test_what_does_not_fit_is_a_value_error(self):
        lines = np.linspace(10.0, 400.0, 50)
        responses = truth(SENSORS, lines)
        with self.assertRaisesRegex(ValueError, "lines x outputs x inputs"):
            chladni.response_field(lines, responses[:, :4], places(SENSORS), places(ACTUATORS),
                                   simulation())
        with self.assertRaisesRegex(chladni.InvalidInput, "dynamic_residual"):
            chladni.response_field(np.linspace(10.0, 400.0, 1561),
                                   truth(SENSORS, np.linspace(10.0, 400.0, 1561)),
                                   places(SENSORS), places(ACTUATORS), simulation(),
                                   method="kriging")

    def test_magnitudes_are_no_responses(self):
        lines = np.linspace(10.0, 400.0, 50)
        responses = truth(SENSORS, lines)
        for real in (abs(responses), responses.real):
            with self.assertRaisesRegex(chladni.InvalidInput, "responses is real, without a phase"):
                chladni.response_field(lines, real, places(SENSORS), places(ACTUATORS),
                                       simulation())
        with self.assertRaisesRegex(chladni.InvalidInput, "variance is complex; expected"):
            chladni.response_field(lines, responses, places(SENSORS), places(ACTUATORS),
                                   simulation(), variance=responses)

    def test_what_is_no_frequency_is_refused(self):
        found = field()
        for wrong in ([np.nan], [100.0, -3.0], [np.inf]):
            with self.assertRaisesRegex(chladni.InvalidInput,
                                        "frequency_hz has .*; expected 0 or more"):
                found.at(places(BETWEEN), wrong)

    def test_complex_shapes_are_no_places(self):
        position = np.zeros((2, 3))
        with self.assertRaisesRegex(chladni.InvalidInput, "shapes is complex; expected"):
            chladni.Places(position, position + [0, 0, 1], np.ones((2, 2), complex))
        with self.assertRaisesRegex(chladni.InvalidInput, r"position has the shape \(2, 2\)"):
            chladni.Places(position[:, :2], position + [0, 0, 1])


if __name__ == "__main__":
    unittest.main()
