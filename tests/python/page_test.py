"""The Python of the pages of the reference, run in order as a reader would.

page_test.py PAGE
"""
import ast
import pathlib
import re
import sys
import unittest
import warnings

import chladni

PAGE = pathlib.Path(sys.argv.pop(1))


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


class Page(unittest.TestCase):
    def test_runs(self):
        warnings.simplefilter("ignore", chladni.ChladniWarning)
        names = {"print": lambda *words: said.append(" ".join(map(str, words)))}
        said = []
        self.assertGreater(len(blocks(PAGE)), 4)
        for block in blocks(PAGE):
            exec(compile(block, str(PAGE), "exec"), names)
        self.assertIn("Hz", said[0])
        self.assertIn('did you mean "edge_length"', said[1])
        self.assertAlmostEqual(names["resolved"]["estimate"]["mass_kg"], 1.62)
        self.assertEqual(names["again"].value.shape, (3, 6, 2))
        self.assertEqual(names["value"].shape, (2, 2, 2))
        self.assertGreater(names["compared"].relative_error, 0.1)
        self.assertEqual(names["judge"]["name"], "s4")
        self.assertLess(names["judge"]["observer"], 0.2 * names["judge"]["rigid_body"])
        self.assertEqual(names["motion"].shape, (16384, 2))

    def test_other_pages_are_python_with_names_of_the_module(self):
        for name in ("interpolation.md", "placement.md"):
            for block in blocks(PAGE.parent / name):
                for node in ast.walk(ast.parse(block)):
                    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and \
                            node.value.id == "chladni":
                        self.assertIn(node.attr, chladni.__all__, name)


if __name__ == "__main__":
    unittest.main()
