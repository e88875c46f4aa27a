"""Studies from files and from dicts: the same study, the same sentences."""
import collections
import pathlib
import random
import re
import string
import tempfile
import tomllib
import types
import unittest

import chladni
from chladni._toml import toml_text
from studies import channels, plate


def anything(draw, depth=0):
    """A value of a study, of any kind."""
    kinds = [lambda: draw.choice([True, False]), lambda: draw.randint(-10**9, 10**9),
             lambda: draw.uniform(-1, 1) * 10.0 ** draw.randint(-300, 300),
             lambda: "".join(draw.choices(string.printable + "µ°\x7f\x01\"\\", k=draw.randint(0, 9)))]
    if depth < 3:
        kinds += [lambda: [anything(draw, depth + 1) for _ in range(draw.randint(0, 3))],
                  lambda: {name(draw): anything(draw, depth + 1) for _ in range(draw.randint(0, 3))}]
    return draw.choice(kinds)()


def name(draw):
    return "".join(draw.choices(string.ascii_letters + "_- .\"é", k=draw.randint(1, 6)))


class Dicts(unittest.TestCase):
    def test_toml_gives_back_what_was_written(self):
        draw = random.Random(7)
        for _ in range(300):
            study = {name(draw): anything(draw) for _ in range(4)}
            self.assertEqual(tomllib.loads(toml_text(study)), study)

    def test_what_is_no_value_is_named(self):
        with self.assertRaisesRegex(TypeError, r"geometry\.plate\.length is \{1\}"):
            chladni.Study({"geometry": {"plate": {"length": {1}}}})
        with self.assertRaisesRegex(TypeError, "a key of a study is text, found 3"):
            chladni.Study({3: "x"})

    def test_any_mapping_is_a_study(self):
        whole = plate(**channels())
        inner = {**whole, "mesh": types.MappingProxyType(whole["mesh"]),
                 "sensor": [collections.UserDict(one) for one in whole["sensor"]]}
        for made in (types.MappingProxyType, collections.UserDict, collections.OrderedDict,
                     lambda one: collections.ChainMap({}, one)):
            study = chladni.Study(made(inner), name="any")
            self.assertEqual(study.check(), chladni.Study(whole, name="any").check())
        self.assertEqual(len(chladni.modes(collections.UserDict(plate())).frequency_hz), 18)

    def test_half_a_character_is_no_text(self):
        for wrong in ({"title": "\ud800"}, {"\ud800": 1}):
            with self.assertRaisesRegex(chladni.InvalidInput, r"'\\ud800'.*; expected text"):
                chladni.Study(plate(**wrong))

    def test_a_dict_is_the_study_of_its_file(self):
        whole = plate(**channels())
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "plate.toml"
            file.write_text(toml_text(whole))
            from_file = chladni.Study(file)
            self.assertEqual(from_file.file, file)
        from_dict = chladni.Study(whole)
        self.assertEqual(from_dict.sha256, from_file.sha256)
        self.assertEqual(from_dict.check(), from_file.check())
        self.assertEqual(from_dict.sensors, ["s1", "s2", "s3", "s4", "s5", "s6", "s7"])
        self.assertEqual(from_dict.actuators, ["a1", "a2"])
        self.assertEqual(from_dict.title, "plate")
        self.assertEqual(tomllib.loads(from_dict.text), whole)

    def test_the_sentences_are_those_of_a_file(self):
        wrong = plate(mesh={"edge_lenght": "40 mm"}, modes={"count": -3})
        with self.assertRaises(chladni.InvalidInput) as of_dict:
            chladni.Study(wrong, name="wrong")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "wrong.toml"
            file.write_text(toml_text(wrong))
            with self.assertRaises(ValueError) as of_file:
                chladni.Study(file)
            self.assertEqual(str(of_file.exception).replace(f"{folder}/", ""),
                             str(of_dict.exception))
        self.assertIn("edge_length", str(of_dict.exception))
        self.assertEqual(len(str(of_dict.exception).splitlines()), 2)

    def test_paths_start_at_the_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            whole = plate(measurement={"frf": "there_is_none.csv"}, **channels())
            study = chladni.Study(whole, folder=folder)
            with self.assertRaisesRegex(chladni.InvalidInput,
                                        re.escape(f"{folder}/there_is_none.csv")):
                study.check()
            whole["measurement"]["frf"] = "../outside.csv"
            with self.assertRaisesRegex(chladni.InvalidInput, "leaves the study's folder"):
                chladni.Study(whole, folder=folder)

    def test_a_file_has_its_own_folder_and_name(self):
        with self.assertRaisesRegex(chladni.InvalidInput, "for a study from a dict"):
            chladni.Study("study.toml", folder="elsewhere")
        with self.assertRaisesRegex(chladni.InvalidInput, "there_is_none.toml"):
            chladni.modes("there_is_none.toml")


class Checks(unittest.TestCase):
    def test_the_resolved_study_is_in_si(self):
        told = chladni.Study(plate()).check()
        self.assertAlmostEqual(told["geometry"]["plate"]["length_m"], 0.3)
        self.assertAlmostEqual(told["estimate"]["mass_kg"], 0.3 * 0.2 * 0.01 * 2700)

    def test_expectations_are_compared(self):
        right = chladni.Study(plate(expect={"mass": {"value": "1.62 kg", "within": "1 g"}}))
        mass = right.check(expect=True)["expect"]["mass"]
        self.assertTrue(mass["met"])
        self.assertLess(abs(mass["found"] - mass["value"]), mass["within"])
        wrong = chladni.Study(plate(expect={"mass": {"value": "1.7 kg", "within": "1 g"}}))
        with self.assertRaises(chladni.NumericalFailure):
            wrong.check(expect=True)


if __name__ == "__main__":
    unittest.main()
