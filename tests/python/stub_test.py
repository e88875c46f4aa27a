"""The stub says what the module has: the same names, arguments and defaults, and docs name them.

stub_test.py PAGE
"""
import ast
import importlib.util
import inspect
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import chladni

PAGE = pathlib.Path(sys.argv.pop(1)) if len(sys.argv) > 1 and sys.argv[1].endswith(".md") else None
FOLDER = pathlib.Path(chladni.__file__).parent
TREE = ast.parse((FOLDER / "__init__.pyi").read_text())


def is_private(name):
    return name.startswith("_") and name not in ("__init__", "__len__", "__call__", "_repr_html_",
                                                 "__version__")


def stub_members(nodes):
    """Functions (with their nodes), properties and classes by name."""
    members = {}
    for node in nodes:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            members[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            members[node.target.id] = node
    return {name: node for name, node in members.items() if not is_private(name)}


def arguments_of_stub(node):
    """[(name, default as text or None, keyword only)]"""
    spec = node.args
    plain = spec.posonlyargs + spec.args
    defaults = [None] * (len(plain) - len(spec.defaults)) + [ast.unparse(d) for d in spec.defaults]
    found = [(a.arg, d, False) for a, d in zip(plain, defaults)]
    found += [(a.arg, None if d is None else ast.unparse(d), True)
              for a, d in zip(spec.kwonlyargs, spec.kw_defaults)]
    return [one for one in found if one[0] != "self"]


def arguments_of_module(value):
    """The same of a function of pybind11, from the line that it puts before its text; None where it
    has several."""
    if inspect.isfunction(value):
        spec = inspect.signature(value).parameters.values()
        kinds = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
        return [(p.name, None if p.default is p.empty else repr(p.default).replace("'", '"'),
                 p.kind is p.KEYWORD_ONLY) for p in spec if p.name != "self" and p.kind not in kinds]
    line = (value.__doc__ or "").splitlines()[0]
    text = re.sub(r"<[^>]*>|array\([^=]*?\)(?=\))|array\(\[\].*?float64\)", "...", line)
    text = re.sub(r"numpy\.ndarray\[[\w.]+(\[[^\]]*\])?\]", "Array", text)
    node = ast.parse(f"def {text}: ...").body[0]
    if node.args.vararg:
        return None
    return [(name, default, only) for name, default, only in arguments_of_stub(node)]


def normal(default):
    return None if default is None else default.replace("'", '"')


class Stub(unittest.TestCase):
    def compare_calls(self, where, node, value):
        module = arguments_of_module(value)
        if module is None:
            return
        stub = arguments_of_stub(node)
        self.assertEqual([(n, k) for n, _, k in stub], [(n, k) for n, _, k in module], where)
        for (name, mine, _), (_, theirs, _) in zip(stub, module):
            if mine == "..." or theirs == "...":
                self.assertEqual(mine is None, theirs is None, f"{where}({name})")
            else:
                self.assertEqual(normal(mine), normal(theirs), f"{where}({name})")

    def test_names_are_those_of_the_module(self):
        self.assertEqual(set(stub_members(TREE.body)), set(chladni.__all__))

    def test_members_are_those_of_the_classes(self):
        for name, node in stub_members(TREE.body).items():
            if not isinstance(node, ast.ClassDef):
                continue
            with self.subTest(name):
                value = getattr(chladni, name)
                members = {n for n, v in vars(value).items() if not is_private(n)}
                stub = stub_members(node.body)
                bases = [ast.unparse(base) for base in node.bases]
                own = [b.__name__ for b in value.__bases__
                       if b.__name__ not in ("object", "pybind11_object")]
                self.assertEqual(bases, own)
                if node.decorator_list:  # a dataclass
                    members = {field for field in value.__dataclass_fields__}
                elif "__init__" not in stub:
                    members.discard("__init__")  # it is not made from Python
                self.assertEqual(set(stub), members)
                for member, inner in stub.items():
                    found = vars(value).get(member)
                    where = f"{name}.{member}"
                    if isinstance(inner, ast.FunctionDef) and not inner.decorator_list:
                        self.compare_calls(where, inner, getattr(found, "__func__", found))
                    elif isinstance(inner, ast.FunctionDef):
                        self.assertIsInstance(found, property, where)
                        self.assertIsNone(found.fset, where)
                    elif not node.decorator_list:
                        self.assertIsNotNone(found.fset, where)

    def test_functions_take_the_same_arguments(self):
        for name, node in stub_members(TREE.body).items():
            if isinstance(node, ast.FunctionDef):
                self.compare_calls(name, node, getattr(chladni, name))

    def test_every_function_and_class_says_what_it_is(self):
        for name in chladni.__all__:
            value = getattr(chladni, name)
            if callable(value) and not issubclass(type(value), type(Exception)):
                text = (value.__doc__ or "").split("\n", 2)
                self.assertTrue(any(len(line) > 10 and "->" not in line for line in text) or
                                "->" in text[0], name)

    def test_the_page_names_everything(self):
        if PAGE is None:
            self.skipTest("no page was given")
        words = set(re.findall(r"\w+", PAGE.read_text()))
        self.assertEqual(sorted(set(chladni.__all__) - words), [])
        for name, node in stub_members(TREE.body).items():
            if isinstance(node, ast.ClassDef) and name not in ("Bar",):
                members = {m for m in stub_members(node.body) if not m.startswith("_")}
                self.assertEqual(sorted(members - words), [], name)

    def test_mypy_agrees(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is not installed (package mypy)")
        # Classes of pybind11 have a metaclass of their own, and those that are not made from Python
        # an __init__ that refuses anything.
        bound = [name for name in chladni.__all__
                 if type(getattr(chladni, name)).__name__ == "pybind11_type"]
        allowed = [f"chladni.{name}{end}" for name in bound for end in ("", ".__init__")]
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "allowed").write_text("\n".join(allowed))
            (folder / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\n")
            done = subprocess.run(
                [sys.executable, "-m", "mypy.stubtest", "chladni", "--concise",
                 "--ignore-missing-stub", "--ignore-unused-allowlist", "--allowlist",
                 folder / "allowed", "--mypy-config-file", folder / "mypy.ini"],
                capture_output=True, text=True, check=False, cwd=folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_package_is_marked_as_typed(self):
        self.assertTrue((FOLDER / "py.typed").exists())


if __name__ == "__main__":
    unittest.main()
