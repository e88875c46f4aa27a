"""Small studies that several tests share, their folder, and what the program says of them."""
import copy
import json
import os
import pathlib
import subprocess
import tempfile
import unittest
import warnings

import chladni
from chladni._toml import toml_text

PLATE = {
    "title": "plate",
    "geometry": {"plate": {"length": "300 mm", "width": "200 mm", "thickness": "10 mm"}},
    "material": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3, "density": "2700 kg/m^3"},
    "mesh": {"edge_length": "40 mm"},
    "modes": {"count": 12, "damping_ratio": 0.005},
}
SENSORS = {"s1": (-140, 90), "s2": (140, 85), "s3": (130, -95), "s4": (-135, -80), "s5": (10, 15),
           "s6": (-60, 40), "s7": (70, -30)}
ACTUATORS = {"a1": "s1", "a2": "s3"}
SPRINGS = [{"kind": "spring", "name": f"spring_{i}", "at": [f"{x} mm", f"{y} mm"], "direction": "z",
            "stiffness": "2 kN/mm"} for i, (x, y) in enumerate([(-100, 0), (100, -60), (90, 70)])]
HIDDEN = {"kind": "mass", "name": "hidden", "at": ["60 mm", "40 mm"], "mass": "40 g"}


def plate(**more):
    """The free plate, with other keys."""
    return {**copy.deepcopy(PLATE), **more}


def channels(sensors=SENSORS):
    """Sensors, and actuators at some of them."""
    def channel(name, place):
        return {"name": name, "at": [f"{x} mm" for x in place], "direction": "z"}
    return {"sensor": [channel(name, place) for name, place in sensors.items()],
            "actuator": [channel(name, SENSORS[at]) for name, at in ACTUATORS.items()]}


class InFolder(unittest.TestCase):
    """Tests of one class in a folder of theirs, without the warnings of small studies."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        warnings.simplefilter("ignore", chladni.ChladniWarning)


def said_by_program(verb, whole, folder, *options):
    """The JSON that the program prints of this study, which it leaves in `folder`/out."""
    file = folder / "study.toml"
    file.write_text(toml_text(whole))
    done = subprocess.run(
        [chladni._chladni._program(), verb, file, "-o", folder / "out", "--json", "--no-pictures",
         *options], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def patience():
    """How much longer a step may take where more is to do than there are processors."""
    return max(1.0, os.getloadavg()[0] / os.cpu_count())


def every_fourth_landing(kind):
    """For a test of some twenty seconds: it runs where the rest by four of the landings is `kind`, as
    tests/rotation draws; CHLADNI_STUDIES=all, or a number, asks for others."""
    asked = os.environ.get("CHLADNI_STUDIES", "")
    if asked == "all":
        return lambda test: test
    root = pathlib.Path(__file__).parent
    said = subprocess.run(["git", "-C", root, "rev-list", "--count", "--first-parent", "HEAD"],
                          capture_output=True, text=True, check=False).stdout
    number = int(asked or said or 2)
    return unittest.skipUnless(number % 4 == kind, "at every fourth landing; CHLADNI_STUDIES=all")
