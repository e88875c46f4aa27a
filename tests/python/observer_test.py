"""chladni.observe: a filter of the identified model, against its own equations and a virtual rig."""
import sys
import unittest

import chladni
import numpy as np
from studies import InFolder, plate, said_by_program

PLACES = {"s1": (-140, 90), "s2": (140, 90), "s3": (140, -90), "s4": (-140, -90), "s5": (20, 10)}


def at(place):
    return [f"{x} mm" for x in place]


def rig(**more):
    """A plate on four soft posts, pushed at its corners and watched there and in the middle."""
    corners = [name for name in PLACES if name != "s5"]
    posts = [{"kind": "spring", "name": f"{axis}_{name}", "at": at(PLACES[name]), "direction": axis,
              "stiffness": "20 N/mm" if axis == "z" else "2 kN/mm"}
             for name in corners for axis in "xyz"]
    return plate(modes={"count": 14, "damping_ratio": 0.01}, attachment=posts,
                 sensor=[{"name": name, "at": at(place), "direction": "z"}
                         for name, place in PLACES.items()],
                 actuator=[{"name": f"a{i}", "at": at(PLACES[name]), "direction": "z"}
                           for i, name in enumerate(corners, 1)], **more)


def laboratory(**more):
    return {"sample_rate": "4096 Hz", "samples": 2048, "band": ["10 Hz", "1000 Hz"],
            "inputs": "orthogonal", "delay": "150 us", **more}


OBSERVER = {"replay": "rig.csv", "noise": "5 nm",
            "point": [{"name": "tool", "at": ["-40 mm", "20 mm"]}],
            "disturbance": [{"name": "amplifier", "kind": "actuators", "rms": "50 mN"}]}
MEASUREMENT = {"frf": "measured.csv", "hold_out": ["s5"]}


class Observer(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        quiet = laboratory(periods=3, realisations=2, warm_up=2, noise="1 nm", compensate="hold")
        chladni.write_frf(cls.folder / "measured.csv", chladni.simulate(rig(experiment=quiet)).frf)
        shaken = laboratory(periods=2, realisations=1, noise="5 nm", process_noise="50 mN",
                            amplitude="0.2 N", leaves="time")
        cls.recordings = chladni.simulate(rig(experiment=shaken)).recordings
        chladni.write_time(cls.folder / "rig.csv", cls.recordings)
        cls.whole = rig(measurement=MEASUREMENT, identification={"unit": "m"}, observer=OBSERVER)
        cls.study = chladni.Study(cls.whole, folder=cls.folder)
        cls.steps = []
        cls.observer = chladni.observe(chladni.modes(cls.study, seed=3), seed=3,
                                       progress=lambda step, part: cls.steps.append(step))

    def test_the_gain_is_that_of_the_riccati_equation(self):
        one, told = self.observer, self.observer.to_dict()
        model = one.disturbed_model
        p, z = len(told["sensor_noise"]), len(one.points)
        known = len(model.inputs) - len(one.disturbances)
        rms = np.array([row["noise_rms"] for row in one.disturbances])
        to_state, through = model.B[:, known:] * rms, model.D[:, known:] * rms
        C, through_sensors = model.C[:p], through[:p]
        cross = model.A @ one.P @ C.T + to_state @ through_sensors.T
        innovation = (C @ one.P @ C.T + through_sensors @ through_sensors.T +
                      np.diag(np.square(told["sensor_noise"])))
        gain = np.linalg.solve(innovation, cross.T).T
        # States have units that differ by many decades: each entry against their deviations. A
        # state that holds a known force is known.
        riccati = model.A @ one.P @ model.A.T + to_state @ to_state.T - gain @ cross.T
        moved = np.diag(one.P) > 0
        self.assertLess(abs(one.P[~moved]).max(), 1e-9 * abs(one.P).max())
        deviation = np.sqrt(np.diag(one.P)[moved])
        off = (riccati - one.P)[np.ix_(moved, moved)] / np.outer(deviation, deviation)
        self.assertLess(abs(off).max(), 1e-6)
        np.testing.assert_allclose(one.innovation_covariance, innovation,
                                   atol=1e-9 * abs(innovation).max())
        scale = deviation[:, None] / np.sqrt(np.diag(innovation))
        self.assertLess((abs(one.L - gain)[moved] / scale).max(), 1e-6)
        self.assertLess(abs(np.linalg.eigvals(model.A - one.L @ C)).max(), 1.0)
        self.assertEqual(one.L_points.shape, (z, p))
        filter_ = np.sqrt(np.diag(one.points_covariance))
        np.testing.assert_allclose(one.deviation_m, one.noise["band_factor"] * filter_, rtol=1e-9)
        self.assertTrue((one.deviation_m < one.prediction_deviation_m).all())
        self.assertTrue((one.prediction_deviation_m < one.deviation_without_sensors_m).all())

    def test_an_estimate_is_the_filter_stepped_by_hand(self):
        one, filter_ = self.observer, self.observer.filter.with_delay_states()
        rng = np.random.default_rng(7)
        inputs, sensors = rng.normal(size=(60, 4)), 1e-6 * rng.normal(size=(60, 4))
        points, deviation = one.estimate(inputs, sensors)
        self.assertEqual(points.shape, (60, 2))
        self.assertEqual(deviation.shape, (60, 2))
        state, mine = np.zeros(len(filter_.A)), []
        for given in np.hstack([inputs, sensors]):
            mine.append((filter_.C @ state + filter_.D @ given)[:2])
            state = filter_.A @ state + filter_.B @ given
        np.testing.assert_allclose(points, mine, rtol=1e-9, atol=1e-12 * abs(points).max())
        self.assertTrue((deviation >= one.deviation_m * (1 - 1e-9)).all())
        with self.assertRaises(chladni.InvalidInput):
            one.estimate(inputs, sensors[:, :3])
        with self.assertRaises(chladni.InvalidInput):
            one.estimate(inputs, np.full_like(sensors, np.nan))
        with self.assertRaisesRegex(chladni.InvalidInput, "sensors is complex; expected n x m"):
            one.estimate(inputs, sensors * 1j)

    def test_the_judge_is_estimated_as_well_as_is_said(self):
        one = self.observer
        judge = one.judges[0]
        self.assertEqual((judge["name"], len(one.judges)), ("s5", 1))
        self.assertEqual(one.points, ["tool", "s5"])
        self.assertEqual([row["held_out_sensor"] for row in one.table], [False, True])
        wrong, motion, within = 0.0, 0.0, []
        settle = round(one.to_dict()["replay"]["settle_s"] / one.sample_time_s)
        for record in self.recordings.records:
            points, deviation = one.estimate(record.inputs, record.outputs[:, :4])
            off = (points[:, 1] - record.outputs[:, 4])[settle:]
            wrong += off @ off
            motion += record.outputs[settle:, 4] @ record.outputs[settle:, 4]
            within.append(abs(off) < 1.96 * np.hypot(deviation[settle:, 1], 5e-9))
        self.assertAlmostEqual(np.sqrt(wrong / motion) / judge["observer"], 1.0, delta=0.02)
        self.assertLess(judge["observer"], 0.5 * judge["rigid_body"])
        self.assertAlmostEqual(np.mean(within), judge["covered"], delta=0.05)

    def test_python_control_or_scipy_takes_the_filter(self):
        taken = self.observer.to_control()
        matrices = taken if isinstance(taken, tuple) else (taken.A, taken.B, taken.C, taken.D,
                                                           taken.dt)
        mine = self.observer.filter.with_delay_states()
        for theirs, own in zip(matrices, (mine.A, mine.B, mine.C, mine.D)):
            np.testing.assert_array_equal(theirs, own)
        self.assertAlmostEqual(matrices[4] * 4096, 1.0)

    def test_it_leaves_what_the_program_leaves(self):
        self.observer.save(self.folder / "saved", pictures=False)
        self.assertEqual({file.name for file in (self.folder / "saved").iterdir()},
                         {"observe.json", "observer.mat", "observer.h"})
        theirs = said_by_program("observe", self.whole, self.folder, "--seed", "3")
        mine = self.observer.to_dict()
        self.assertEqual({key: theirs[key] for key in mine}, mine)
        self.assertEqual((self.folder / "saved" / "observer.h").read_text(),
                         (self.folder / "out" / "observer.h").read_text())
        for note in mine["notes"] + mine["replay"]["notes"]:
            self.assertIn(note, self.observer.warnings)
        self.assertIn("s5", str(self.observer))
        self.assertIn("replay", self.observer.seconds)
        self.assertNotIn("assembly", self.observer.seconds)  # the modes were there
        self.assertNotEqual(self.steps, [])

    def test_arrays_are_views_that_cannot_be_written_to(self):
        self.assertTrue(np.shares_memory(self.observer.L, self.observer.L))
        with self.assertRaises(ValueError):
            self.observer.L[0, 0] = 1.0

    def test_what_its_progress_raises_ends_it(self):
        def stop(step, part):
            raise KeyboardInterrupt(step)
        with self.assertRaises(KeyboardInterrupt):
            chladni.observe(self.study, progress=stop)

    def test_what_lacks_is_refused_before_it_solves(self):
        def refused(pattern, **more):
            steps = []
            with self.assertRaisesRegex(chladni.InvalidInput, pattern):
                chladni.observe(chladni.Study({**self.whole, **more}, folder=self.folder),
                                progress=lambda step, part: steps.append(step))
            self.assertEqual(steps, [])
        refused("rig/none.csv: there is no such file", observer={**OBSERVER, "replay": "rig/none.csv"})
        refused("stands on an identified model", measurement={"modes": "modes.csv"})
        whole = {key: value for key, value in self.whole.items() if key != "observer"}
        with self.assertRaisesRegex(chladni.InvalidInput, r"there is no \[observer\]"):
            chladni.observe(chladni.Study(whole, folder=self.folder))


if __name__ == "__main__":
    if len(sys.argv) == 3:
        source, sample = sys.argv[1:]
        del sys.argv[1:]
        sys.path.insert(0, f"{source}/tests/rotation")
        from turn import why_skipped
        if why := why_skipped("python.observer", sample, source):
            print(why)
            sys.exit(77)
    unittest.main()
