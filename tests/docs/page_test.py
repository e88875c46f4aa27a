"""What the tests of pages take for the same, and what not."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True  # a new folder here would look like a newer source
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "rotation"))
import page
from turn import has_turn


class Lines(unittest.TestCase):
    def test_numbers_may_differ_by_two_percent_or_two_units_of_the_last_digit(self):
        self.assertTrue(page.is_as_promised("mode 7 384.32 Hz", "mode  7  384.36 Hz"))
        self.assertTrue(page.is_as_promised("mass 19.4 kg", "mass 19.45 kg"))
        self.assertTrue(page.is_as_promised("0.001", "0.003"))
        self.assertFalse(page.is_as_promised("0.001", "0.0031"))
        self.assertFalse(page.is_as_promised("mode 7 384.32 Hz", "mode 7 394.32 Hz"))
        self.assertTrue(page.is_as_promised("1.2e-05", "1.3e-05"))
        self.assertFalse(page.is_as_promised("1.2e-05", "1.2e-04"))

    def test_words_are_the_same(self):
        self.assertFalse(page.is_as_promised("verdict: named", "verdict: partial"))
        self.assertFalse(page.is_as_promised("two words", "two words more"))
        self.assertFalse(page.is_as_promised("-3", "3 -"))
        self.assertTrue(page.is_as_promised("two words ...", "two words and more"))
        self.assertFalse(page.is_as_promised("two words ...", "two word and more"))

    def test_lines_come_in_the_pages_order(self):
        printed = "a 1\nb 2\nc 3\n"
        self.assertIsNone(page.missing_line("a 1\n...\nc 3\n", printed))
        self.assertEqual(page.missing_line("c 3\na 1\n", printed), "a 1")
        self.assertEqual(page.missing_line("d\n", printed), "d")

    def test_blocks_have_language_title_and_content(self):
        text = 'x\n```toml title="a.toml"\nb = 1\n```\n\n```sh\nls\n```\n'
        self.assertEqual(page.blocks(text), [("toml", "a.toml", "b = 1\n"), ("sh", None, "ls\n")])


class Turns(unittest.TestCase):
    def test_come_once_in_four_landings_in_a_row(self):
        first = [next(n for n in range(4) if has_turn(f"docs.tutorial.{i}", n)) for i in range(200)]
        for begin in (46, 47):
            self.assertEqual(sum(has_turn("a", n) for n in range(begin, begin + 4)), 1)
        for quarter in range(4):
            self.assertAlmostEqual(first.count(quarter), 50, delta=30)  # five deviations of a draw


if __name__ == "__main__":
    unittest.main()
