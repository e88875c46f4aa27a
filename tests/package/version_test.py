"""The version of a checkout, of a changed one, of an archive and of neither.

version_test.py ROOT
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
GIT = shutil.which("git")


def git(folder, *words):
    done = subprocess.run([GIT, "-C", folder, "-c", "user.name=n", "-c", "user.email=e", *words],
                          check=True, capture_output=True, text=True)
    return done.stdout.strip()


@unittest.skipUnless(GIT, "there is no git here")
class Version(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name).resolve()
        self.tree = self.folder / "tree"
        (self.tree / "cmake").mkdir(parents=True)
        for name in ("cmake/commit.txt", ".gitattributes"):
            shutil.copy(ROOT / name, self.tree / name)
        (self.tree / "file").write_text("one")

    def commit(self):
        git(self.tree, "init", "-q")
        git(self.tree, "add", ".")
        git(self.tree, "commit", "-q", "-m", "first")
        return git(self.tree, "rev-parse", "HEAD")[:10]

    def version(self, tree):
        output = self.folder / "version.cpp"
        subprocess.run(["cmake", "-D", f"SOURCE={tree}", "-D", "VERSION=1.2.3", "-D",
                        f"OUTPUT={output}", "-P", ROOT / "cmake/write_version.cmake"], check=True)
        return output.read_text().split('return "')[1].split('"')[0]

    def test_of_a_checkout_names_its_commit(self):
        commit = self.commit()
        self.assertEqual(self.version(self.tree), f"1.2.3+g{commit}")
        (self.tree / "file").write_text("two")
        self.assertEqual(self.version(self.tree), f"1.2.3+g{commit}-dirty")
        git(self.tree, "add", ".")
        self.assertEqual(self.version(self.tree), f"1.2.3+g{commit}-dirty")
        git(self.tree, "commit", "-q", "-m", "second")
        self.assertNotEqual(self.version(self.tree), f"1.2.3+g{commit}")
        self.assertFalse(self.version(self.tree).endswith("dirty"))

    def test_of_an_archive_names_its_commit(self):
        commit = self.commit()
        git(self.tree, "archive", "-o", self.folder / "a.tar", "HEAD")
        unpacked = self.folder / "unpacked"
        unpacked.mkdir()
        subprocess.run(["tar", "-xf", self.folder / "a.tar", "-C", unpacked], check=True)
        self.assertEqual(self.version(unpacked), f"1.2.3+g{commit}")

    def test_of_neither_says_so(self):
        self.assertEqual(self.version(self.tree), "1.2.3+unknown-commit")

    def test_of_a_tree_inside_another_checkout_is_not_that_ones(self):
        self.commit()
        inside = self.tree / "third_party"
        shutil.copytree(self.tree / "cmake", inside / "cmake")
        self.assertEqual(self.version(inside), "1.2.3+unknown-commit")

    def test_is_written_only_where_it_changed(self):
        self.commit()
        self.version(self.tree)
        before = (self.folder / "version.cpp").stat().st_mtime_ns
        self.version(self.tree)
        self.assertEqual((self.folder / "version.cpp").stat().st_mtime_ns, before)


if __name__ == "__main__":
    unittest.main()
