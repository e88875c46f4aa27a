"""The tools in cmake/ that no build runs: whose turn a kernel of BLAS is, and when verdicts agree.

tools_test.py ROOT
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1)).resolve()
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "cmake"))

import blas_kernels  # noqa: E402
import same_verdicts  # noqa: E402


class Turns(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name).resolve()
        self.tree = self.folder / "tree"
        self.tree.mkdir()
        self.git("init", "-q")
        for landing in range(9):
            self.git("-c", "user.name=n", "-c", "user.email=n@example.org", "commit", "-q",
                     "--allow-empty", "-m", str(landing))

    def git(self, *words):
        done = subprocess.run(["git", "-C", self.tree, *words], check=True, capture_output=True,
                              text=True)
        return done.stdout.strip()

    def test_change_with_every_fourth_landing(self):
        self.assertEqual(blas_kernels.turn_of(self.tree), 2)

    def test_of_a_shallow_clone_are_drawn_by_its_hash(self):
        shallow = self.folder / "shallow"
        subprocess.run(["git", "clone", "-q", "--depth", "1", f"file://{self.tree}", shallow],
                       check=True, capture_output=True)
        drawn = int(self.git("rev-parse", "HEAD")[:8], 16)
        self.assertEqual(blas_kernels.turn_of(shallow), drawn // 4000)

    def test_where_there_is_no_git_are_the_first(self):
        self.assertEqual(blas_kernels.turn_of(self.folder), 0)


class Verdicts(unittest.TestCase):
    @staticmethod
    def named(*channels):
        causes = [{"effect": "loose screw", "channels": list(channels), "probability": 0.9}]
        return "named", same_verdicts.told_causes({"causes": causes})

    def test_agree_where_effects_and_channels_do(self):
        first = same_verdicts.names(self.named("s1", "s2"))
        self.assertEqual(first, same_verdicts.names(self.named("s1", "s2")))
        self.assertNotEqual(first, same_verdicts.names(self.named("s1", "s3")))


if __name__ == "__main__":
    unittest.main()
