"""Best places on arrays: a pinned beam, whose modes are sines."""
import unittest

import chladni
import numpy as np

LENGTH = 2.0


def shapes(x, modes=6):
    return np.sqrt(2.0) * np.sin(np.outer(x, np.arange(1, modes + 1)) * np.pi / LENGTH)


def lines(x):
    position = np.column_stack([x, np.zeros((len(x), 2))])
    return position, np.tile([0.0, 0.0, 1.0], (len(x), 1))


def channels(*x):
    position, direction = lines(np.array(x))
    return chladni.Channels(position, direction, shapes(np.array(x)))


def beam(**more):
    return chladni.Structure(50.0 * np.arange(1, 7) ** 2, mass_kg=1.0, size=LENGTH, **more)


def sites(count):
    x = np.linspace(0.0, LENGTH, count)
    return chladni.Sites(lines(x)[0], np.full(count, 1e-3), shapes(x))


class Placement(unittest.TestCase):
    def test_a_pair_for_two_modes_sits_at_a_third_of_the_span(self):
        plan = chladni.PlacementPlan()
        plan.modes = [1, 2]
        best = chladni.best_pairs(beam(), sites(601), plan)
        x = best[0].position[0]
        self.assertAlmostEqual(min(x, LENGTH - x), LENGTH / 3, places=9)
        self.assertAlmostEqual(best[0].score, np.sqrt(0.75), places=9)

    def test_two_sites_have_the_largest_determinant(self):
        plan = chladni.PlacementPlan()
        plan.modes = [1, 2]
        plan.sites = 2
        best = chladni.best_layouts(beam(), sites(201), plan)[0]
        self.assertEqual(best.by, "determinant")
        self.assertEqual(len(best.rows), 2)
        wanted = LENGTH * np.arctan(np.sqrt(2.0)) / np.pi
        np.testing.assert_allclose(np.sort(best.sites[:, 0]), [wanted, LENGTH - wanted], atol=0.01)

    def test_a_layout_is_scored_without_a_study(self):
        structure = beam(sensors=channels(1.0, 0.42), actuators=channels(1.0))
        plan = chladni.PlacementPlan()
        middle = chladni.layout_score(structure, sites(201), plan, [0], [0])
        self.assertEqual(middle["blind_modes"], [2, 4, 6])
        self.assertEqual(middle["collocated_pairs"], 1)
        self.assertEqual(middle["scores"]["observed_points"], 1)
        self.assertEqual(chladni.layout_score(structure, sites(201), plan, [1], [])["blind_modes"],
                         [])

    def test_slopes_that_are_not_known_are_not_zero(self):
        plan = chladni.PlacementPlan()
        plan.position_error = 1e-3
        with self.assertRaisesRegex(chladni.InvalidInput, "0.001 m and the Sites have no slopes"):
            chladni.best_pairs(beam(), sites(11), plan)
        with self.assertRaisesRegex(chladni.InvalidInput, "the Sites have no slopes"):
            chladni.best_layouts(beam(), sites(11), plan)
        with self.assertRaisesRegex(chladni.InvalidInput, "the Sites have no slopes"):
            chladni.layout_score(beam(sensors=channels(1.0)), sites(11), plan, [0], [])
        x = np.linspace(0.0, LENGTH, 11)
        known = chladni.Sites(lines(x)[0], np.full(11, 1e-3), shapes(x), np.ones((11, 6)))
        self.assertTrue(chladni.best_pairs(beam(), known, plan))

    def test_what_does_not_fit_is_a_value_error(self):
        plan = chladni.PlacementPlan()
        with self.assertRaisesRegex(ValueError, "the number of modes on the surface is 6"):
            chladni.best_pairs(chladni.Structure([1.0, 2.0], 1.0, LENGTH), sites(11), plan)
        with self.assertRaisesRegex(chladni.InvalidInput, "channel 0 of a layout does not exist"):
            chladni.layout_score(beam(), sites(11), plan, [0], [])
        plan.criterion = "luck"
        for search in (chladni.best_pairs, chladni.best_layouts):
            with self.assertRaisesRegex(chladni.InvalidInput, "weakest_mode"):
                search(beam(), sites(11), plan)

    def test_a_plan_that_cannot_be_meant_is_refused(self):
        nan, inf = np.nan, np.inf
        wrong = {"noise": (-1, 0, nan, inf), "up_to_hz": (-5, nan), "pairs": (0, -1, 101),
                 "spacing": (-1, nan), "frequency_tolerance": (-0.1, nan), "sites": (-1,),
                 "position_error": (-1e-3, nan)}
        structure = beam(sensors=channels(1.0))
        x = np.linspace(0.0, LENGTH, 11)
        known = chladni.Sites(lines(x)[0], np.full(11, 1e-3), shapes(x), np.ones((11, 6)))
        for name, values in wrong.items():
            for value in values:
                plan = chladni.PlacementPlan()
                setattr(plan, name, value)
                for search in (chladni.best_pairs, chladni.best_layouts,
                               lambda *all: chladni.layout_score(*all, [0], [])):
                    with self.subTest(f"{name} {value}"), \
                            self.assertRaisesRegex(chladni.InvalidInput, f"plan.{name} is "):
                        search(structure, known, plan)

    def test_places_that_cannot_be_meant_are_refused(self):
        x = np.linspace(0.0, LENGTH, 11)
        position, area = lines(x)[0], np.full(11, 1e-3)
        with self.assertRaisesRegex(chladni.InvalidInput, "position of place 0 is not finite"):
            chladni.Sites(position * np.nan, area, shapes(x))
        for wrong in (-area, area * np.nan):
            with self.assertRaisesRegex(chladni.InvalidInput, "area of place 0 is .*; expected"):
                chladni.Sites(position, wrong, shapes(x))
        with self.assertRaisesRegex(chladni.InvalidInput, r"position has the shape \(11, 2\)"):
            chladni.Sites(position[:, :2], area, shapes(x))
        for size in (-1, 0, np.nan, np.inf):
            with self.assertRaisesRegex(chladni.InvalidInput, "size is "):
                chladni.Structure(50.0 * np.arange(1, 7) ** 2, mass_kg=1.0, size=size)
        for mass in (-1, 0, np.nan):
            with self.assertRaisesRegex(chladni.InvalidInput, "mass_kg is "):
                chladni.Structure(50.0 * np.arange(1, 7) ** 2, mass_kg=mass, size=LENGTH)
        with self.assertRaisesRegex(chladni.InvalidInput, "frequency_hz has -1"):
            chladni.Structure([-1.0, 2.0], mass_kg=1.0, size=LENGTH)
        with self.assertRaisesRegex(chladni.InvalidInput, "damping_ratio has -0.1"):
            beam(damping_ratio=np.full(6, -0.1))
        with self.assertRaisesRegex(chladni.InvalidInput, "seed is -1; expected"):
            chladni.best_layouts(beam(), sites(11), chladni.PlacementPlan(), seed=-1)
        with self.assertRaisesRegex(chladni.InvalidInput, "channel -1"):
            chladni.layout_score(beam(), sites(11), chladni.PlacementPlan(), [-1], [])


if __name__ == "__main__":
    unittest.main()
