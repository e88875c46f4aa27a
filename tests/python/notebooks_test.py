"""The notebooks: kept without results, and their cells run.

notebooks_test.py FOLDER
"""
import ast
import json
import pathlib
import sys
import unittest
import warnings

import chladni
import numpy as np
from studies import every_fourth_landing

FOLDER = pathlib.Path(sys.argv.pop(1))


def cells(name):
    return json.loads((FOLDER / name).read_text())["cells"]


def run(name):
    """Runs the cells of code as a notebook does: the value of a last expression is shown. Gives the
    names and what was shown of each cell."""
    names, shown = {"print": lambda *words: None}, []
    for number, cell in enumerate(cells(name)):
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]))
        value = None
        last = tree.body[-1] if isinstance(tree.body[-1], ast.Expr) else None
        if last:
            tree.body.pop()
        exec(compile(tree, f"{name}, cell {number}", "exec"), names)
        if last:
            value = eval(compile(ast.Expression(last.value), f"{name}, cell {number}", "eval"), names)
        shown.append(value._repr_html_() if hasattr(value, "_repr_html_") else repr(value))
    return names, shown


class Notebooks(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", chladni.ChladniWarning)

    def test_are_kept_without_results(self):
        files = sorted(file.name for file in FOLDER.glob("*.ipynb"))
        self.assertEqual(files, ["first_stage.ipynb", "measured_to_verdict.ipynb", "place.ipynb"])
        for name in files:
            notebook = json.loads((FOLDER / name).read_text())
            self.assertEqual((notebook["nbformat"], notebook["nbformat_minor"]), (4, 5))
            ids = [cell["id"] for cell in notebook["cells"]]
            self.assertEqual(len(set(ids)), len(ids))
            for cell in notebook["cells"]:
                if cell["cell_type"] == "code":
                    self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))
            self.assertLess((FOLDER / name).stat().st_size, 10_000)

    def test_first_stage(self):
        names, shown = run("first_stage.ipynb")
        self.assertTrue(any(one.startswith("<iframe") for one in shown))
        # Free bending goes with the thickness, less by the springs.
        ratio = names["stiffer"].frequency_hz[6:9] / names["modes"].frequency_hz[6:9]
        np.testing.assert_allclose(ratio, 1.2, atol=0.06)
        self.assertLess(abs(names["modes"].frequency_hz - names["peak"]).min(), 2.0)

    def test_place(self):
        names, _ = run("place.ipynb")
        placement = names["placement"]
        self.assertFalse(names["admissible"].all())
        inside = np.linalg.norm(placement.points[:, :2], axis=1) < 0.030
        self.assertFalse(names["admissible"][inside].any())
        self.assertGreater(placement.layouts[1]["scores"]["determinant"],
                           placement.layouts[0]["scores"]["determinant"])

    @every_fourth_landing(1)
    def test_measured_to_verdict(self):
        names, shown = run("measured_to_verdict.ipynb")
        cause = names["cause"]
        self.assertEqual((names["found"].verdict, cause.effect), ("named", "point_mass"))
        self.assertLess(abs(cause.parameters["mass"].value - 0.040), 0.002)
        np.testing.assert_allclose(cause.place[:2], [0.060, 0.040], atol=0.004)
        real, off = names["truth"].frequency_hz[3:9], names["before"].frequency_hz[3:9]
        self.assertLess(abs(names["after"].frequency_hz[3:9] - real).max(), 0.2 * abs(off - real).max())
        self.assertTrue(any("measured_to" in one or "iframe" in one for one in shown))


if __name__ == "__main__":
    unittest.main()
