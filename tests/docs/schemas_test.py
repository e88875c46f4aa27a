#!/usr/bin/env python3
"""Every JSON file that a verb leaves agrees with its schema in docs/reference/schemas.

schemas_test.py SOURCE CHLADNI SAMPLE
Small studies are run. The diagnosis of responses has its turn at every fourth landing.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import jsonschema

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
SAMPLE = pathlib.Path(sys.argv.pop(3)).resolve()
CHLADNI = pathlib.Path(sys.argv.pop(2)).resolve()
SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(SOURCE / "tests/rotation"))
from schema_samples import CONTRACT, EXPECT, INNER_CONTRACT, MEASURED, ON_IT, PLAN, PLATE, RECORDED, channels
from turn import why_skipped

SCHEMAS = SOURCE / "docs/reference/schemas"


def schema_of(name):
    return json.loads((SCHEMAS / name).read_text())


def rows_of(page):
    """The cells of each row of the tables of a page of the reference."""
    lines = (SCHEMAS.parent / page).read_text().splitlines()
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line.startswith("| `")]


def verbs_in(cell):
    return re.findall(r"`([a-z]+)`", cell)


def left_by(verb):
    """The files that json.md says the verb leaves."""
    return {name for files, verbs, *_ in rows_of("json.md") if verb in verbs_in(verbs)
            for name in re.findall(r"`([a-z_]+\.json)`", files)}


def unexplained(schema, path):
    """Keys without a description."""
    for key, value in schema.get("properties", {}).items():
        if not value.get("description") and "$ref" not in value:
            yield f"{path}/{key}"
        yield from unexplained(value, f"{path}/{key}")
    for key in ("items", "additionalProperties"):
        if isinstance(schema.get(key), dict):
            yield from unexplained(schema[key], path)
    for key, value in schema.get("$defs", {}).items():
        yield from unexplained(value, f"{path}#{key}")


def part(schema, path):
    for key in path:
        schema = schema[key]
    return schema


def validator_of(name, schema):
    others = jsonschema.RefResolver((SCHEMAS / name).as_uri(), schema_of(name))
    return jsonschema.Draft202012Validator(schema, resolver=others)


def branches(name, schema, content):
    """The parts of the schema, in the file of that name, that `content` is held to: (name, part) each."""
    yield name, schema
    parts = [(name, one) for one in schema.get("allOf", [])]
    parts += [(name, one) for word in ("anyOf", "oneOf") for one in schema.get(word, [])
              if validator_of(name, one).is_valid(content)]
    if "if" in schema:
        met = validator_of(name, schema["if"]).is_valid(content)
        parts.append((name, schema.get("then" if met else "else", {})))
    if "$ref" in schema:
        file, _, place = schema["$ref"].partition("#")
        parts.append((file or name, part(schema_of(file or name), place.strip("/").split("/"))))
    for file, one in parts:
        yield from branches(file, one, content)


def inner_of(schema, key):
    """What the schema says of the value of a key; nothing where it does not explain the key."""
    if key in schema.get("properties", {}):
        return [schema["properties"][key]]
    others = schema.get("additionalProperties", False)
    return [] if others is False else [others]


def strange_keys(schemas, content, path=""):
    """Keys of `content` that none of the schemas, (file, schema) each, explains. True explains all."""
    if not isinstance(content, (dict, list)) or any(schema is True for _, schema in schemas):
        return
    held_to = [pair for name, schema in schemas for pair in branches(name, schema, content)]
    if isinstance(content, list):
        items = [(name, schema["items"]) for name, schema in held_to if "items" in schema]
        for entry in content:
            yield from strange_keys(items, entry, path)
        return
    for key, value in content.items():
        known = [(name, inner) for name, schema in held_to for inner in inner_of(schema, key)]
        if known:
            yield from strange_keys(known, value, f"{path}/{key}")
        else:
            yield f"{path}/{key}"


class Schemas(unittest.TestCase):
    def test_are_schemas(self):
        for file in SCHEMAS.glob("*.json"):
            schema = json.loads(file.read_text())
            jsonschema.Draft202012Validator.check_schema(schema)
            self.assertEqual(list(unexplained(schema, file.name)), [])

    def test_require_what_others_rely_on(self):
        for name, keys in CONTRACT.items():
            self.assertLessEqual(keys, set(schema_of(name)["required"]), name)
        for (name, *path), keys in INNER_CONTRACT.items():
            self.assertLessEqual(keys, set(part(schema_of(name), path)["required"]), (name, *path))

    def test_are_named_on_the_page(self):
        page = (SCHEMAS.parent / "json.md").read_text()
        for file in SCHEMAS.glob("*.json"):
            self.assertIn(f"(schemas/{file.name})", page)

    def test_the_verb_study_takes_the_steps_whose_files_it_leaves(self):
        steps = next(verbs_in(does) for verb, does, *_ in rows_of("cli.md") if verb == "`study`")
        leaves = {verbs_in(verbs)[0] for _, verbs, *_ in rows_of("json.md") if "study" in verbs_in(verbs)}
        self.assertEqual(set(steps), leaves)


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        place = tempfile.TemporaryDirectory(prefix="chladni_schemas_")
        cls.addClassCleanup(place.cleanup)
        cls.folder = pathlib.Path(place.name)
        cls.study = cls.folder / "study.toml"
        cls.study.write_text(PLATE % "8 mm" + ON_IT % "40 g" + MEASURED + channels())
        cls.ran = set()

    def run_verb(self, verb, study, *more):
        out = self.folder / study.stem / verb
        paints = verb not in ("check", "mesh", "export", "priors", "simulate", "sweep")
        pictures = ["--no-pictures"] if paints else []
        done = subprocess.run([CHLADNI, verb, study, "-o", out, "--threads", "1", *pictures, *more],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{verb}: {done.stdout}{done.stderr}")
        return out

    def agrees(self, file, schema_name=None):
        """The file agrees with its schema, and would not without any of the keys required."""
        name = schema_name or file.name
        schema = schema_of(name)
        content = json.loads(file.read_text())
        validator = validator_of(name, schema)
        faults = [f"{file.name}: {list(fault.absolute_path)}: {fault.message}"
                  for fault in validator.iter_errors(content)]
        self.assertEqual(faults[:5], [])
        self.assertEqual(sorted(set(strange_keys([(name, schema)], content))), [], f"in no schema: {file}")
        for key in schema["required"]:
            less = {k: v for k, v in content.items() if k != key}
            self.assertFalse(validator.is_valid(less), f"{file.name} without {key}")
        return content

    def all_agree(self, out, without=frozenset()):
        """What a verb left is what json.md says, but for what this study does not ask for."""
        left = {f.name for f in out.glob("*.json")}
        self.assertEqual(left, left_by(out.name) - without, out.name)
        for name in left:
            self.agrees(out / name, "state_space.json" if name == "simulated_state_space.json" else None)

    def all_drawn(self, out, names):
        """`figure` draws these from what a verb left, no reason is against any, and its answer agrees."""
        command = [CHLADNI, "figure", out, "--format", "svg", "--json", "-o", out / "figures"]
        answer = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
        (self.folder / "figure.json").write_text(answer)
        figures = self.agrees(self.folder / "figure.json")["figures"]
        self.assertEqual({one["name"]: one["reason"] for one in figures}, dict.fromkeys(names))

    def test_of_the_simulation(self):
        for verb in ("check", "mesh", "modes", "export", "place", "priors"):
            self.all_agree(self.run_verb(verb, self.study))

    def test_of_priors_that_learn_the_noise(self):
        study = self.folder / "learned.toml"
        study.write_text(PLATE % "8 mm" + '[priors]\nmodes = 2\nsamples = [30]\nnoise_ratio = "learned"\n')
        out = self.run_verb("priors", study)
        self.all_agree(out)
        self.assertIsNone(json.loads((out / "priors.json").read_text())["noise_ratio"])

    def test_of_expectations(self):
        study = self.folder / "expects.toml"
        study.write_text(PLATE % "8 mm" + EXPECT)
        out = self.run_verb("check", study, "--expect")
        self.all_agree(out)
        expect = json.loads((out / "study.json").read_text())["expect"]
        self.assertEqual(set(expect), {"mass", "frequency_1"})
        for one in expect.values():
            self.assertTrue(one["met"])
            self.assertLess(abs(one["found"] - one["value"]), one["within"])

    def test_of_measured_data(self):
        for verb in ("simulate", "identify", "interpolate", "compare", "observe"):
            self.all_agree(self.run_verb(verb, self.study))
        self.all_drawn(self.folder / "study/compare", {"frequency_errors", "mac", "errors"})
        self.curves_agree()
        whole = self.folder / "whole.toml"
        whole.write_text(self.study.read_text().split("[diagnosis]")[0] + channels())
        self.all_agree(self.run_verb("study", whole), without={"diagnosis.json"})
        self.diagnosed_modes()
        if not (why := why_skipped("docs.schemas.diagnosis", SAMPLE, SOURCE)):
            self.diagnosed_responses()
        else:
            print(f"the diagnosis of responses {why}")

    def test_of_recordings(self):
        study = self.folder / "recorded.toml"
        study.write_text(PLATE % "8 mm" + RECORDED + channels())
        self.all_agree(self.run_verb("simulate", study))
        out = self.run_verb("identify", study)
        self.all_agree(out)
        told = json.loads((out / "identified.json").read_text())
        self.assertLessEqual({"data_quality", "complex_shapes", "rigid_body"}, set(told))
        self.assertIn("distortion", told["data_quality"])
        self.all_drawn(out, {"stabilisation"})

    def test_a_comparison_is_one_of_responses_or_of_modes(self):
        """Neither passes as the other."""
        of_modes = {"modes": [{"simulated_hz": 1.0, "measured_hz": 1.0, "change": 0.0, "mac": None}]}
        schema = {**schema_of("comparison.json"), "required": []}
        validator = validator_of("comparison.json", schema)
        self.assertTrue(validator.is_valid(of_modes))
        self.assertFalse(validator.is_valid({"modes": [{"measured_hz": 1.0}]}))
        self.assertFalse(validator.is_valid({**of_modes, "band_hz": [1.0, 2.0]}))

    def curves_agree(self):
        """With its pictures a verb leaves their curves."""
        out = self.folder / "study/drawn"
        subprocess.run([CHLADNI, "compare", self.study, "-o", out, "--threads", "1"], capture_output=True, check=True)
        curves = self.agrees(out / "responses_curves.json", "curves.json")
        self.assertEqual([len(pane["series"]) for pane in curves["panes"]], [3, 2, 2])
        self.all_drawn(out, {"frequency_errors", "mac", "errors", "responses"})

    def diagnosed_responses(self):
        study = self.folder / "believed.toml"
        study.write_text(PLATE % "8 mm" + MEASURED + channels())
        out = self.run_verb("diagnose", study)
        self.all_agree(out)
        told = json.loads((out / "diagnosis.json").read_text())
        self.assertEqual([c["effect"] for c in told["causes"]], ["point_mass"])
        self.all_drawn(out, {"frequency_errors", "mac", "errors", "errors_over_frequency"})

    def diagnosed_modes(self):
        modes = self.run_verb("modes", self.study) / "modes.json"
        frequencies = json.loads(modes.read_text())["frequency_hz"][6:]
        (self.folder / "modes.csv").write_text(
            "frequency_hz,std_frequency_hz\n"
            + "".join(f"{1.03 * f},{1e-3 * f}\n" for f in frequencies[:6]))
        sheet = (PLATE % "8 mm").replace('"70 GPa"', '{ value = "70 GPa", within = "10 %" }')
        for name in ("one", "two"):
            (self.folder / f"{name}.toml").write_text(
                f'{sheet}{channels()}[measurement]\nmodes = "modes.csv"\n')
        self.all_agree(self.run_verb("diagnose", self.folder / "one.toml"))
        self.all_agree(self.run_verb("compare", self.folder / "one.toml"))
        several = self.folder / "several.toml"
        several.write_text(PLATE % "8 mm" + "".join(
            f'[[specimen]]\nname = "{n}"\nstudy = "{n}.toml"\n' for n in ("one", "two")))
        self.all_agree(self.run_verb("diagnose", several))

    def test_of_designed_experiments(self):
        for name in ("experiment", "hammer_design"):
            study = SOURCE / "models/recordings" / f"{name}.toml"
            self.all_agree(self.run_verb("experiment", study))

    def test_of_a_sweep(self):
        (plan := self.folder / "plan.toml").write_text(PLAN)
        out = self.run_verb("sweep", plan)
        table = self.agrees(out / "sweep.json")
        self.assertEqual(len(table["variants"]), 2)
        for variant in table["variants"]:
            self.agrees(out / variant["folder"] / "variant.json")


if __name__ == "__main__":
    unittest.main()
