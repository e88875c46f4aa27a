"""The build backend of PEP 517 that pyproject.toml names: CMake builds, this packs the wheel.

    pip install .
    pip install . --config-settings build-dir=build/release --config-settings jobs=2

The wheel has the package, its compiled module, and in chladni/bin and chladni/libexec the programs
that the module starts. It links the libraries of Debian that it was built with, so it is for this
machine alone. docs/decisions/0015-python-package.md says why there is no scikit-build-core.
"""
import base64
import hashlib
import os
import pathlib
import platform
import re
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"
DEBIAN = pathlib.Path("/usr/bin/python3")


def _run(*command):
    words = [str(word) for word in command]
    print("+", *words, flush=True)
    if subprocess.run(words, check=False, cwd=ROOT).returncode:
        raise SystemExit(f"chladni: {' '.join(words)} failed; the packages of packages.txt are "
                         "needed: ./chladni --version installs them")


def _is_debians(python):
    """Whether a module for Debian's Python is one for this one."""
    if not DEBIAN.exists():
        return False
    suffix = subprocess.run([DEBIAN, "-c", "import sysconfig; print(sysconfig.get_config_var("
                             "'EXT_SUFFIX'))"], capture_output=True, text=True, check=False).stdout
    return suffix.strip() == python


def _built(settings):
    """The build folder with the module and the programs in it."""
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    own = [] if _is_debians(suffix) else [f"-DPython3_EXECUTABLE={sys.executable}"]
    usual = ROOT / "build" / (f"python-{TAG}" if own else "release")
    build = pathlib.Path(settings.get("build-dir") or usual)
    build = build if build.is_absolute() else ROOT / build
    jobs = settings.get("jobs") or str(os.cpu_count())
    if own or not (build / "build.ninja").exists():
        _run("cmake", "--preset", "release", "-B", build, *own)
    _run("cmake", "--build", build, "--parallel", jobs, "--target", "programs", "chladni_python")
    return build


def _staged(build, stage):
    """What of the installation belongs into the package: {name in the wheel: file}."""
    for component in ("programs", "python"):
        _run("cmake", "--install", build, "--prefix", stage, "--component", component, "--strip")
    files = {}
    package = next(stage.glob("lib/python*/dist-packages/chladni"))
    for folder, name in ((package, "chladni"), (stage / "bin", "chladni/bin"),
                         (stage / "libexec/chladni", "chladni/libexec/chladni")):
        files.update({f"{name}/{file.name}": file for file in sorted(folder.iterdir())
                      if file.is_file()})
    return files


def _version():
    """That of cmake/write_version.cmake, as PEP 440 has local versions."""
    number = re.search(r"project\(chladni VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "version.cpp"
        subprocess.run(["cmake", "-D", f"SOURCE={ROOT}", "-D", f"VERSION={number}", "-D",
                        f"OUTPUT={file}", "-P", ROOT / "cmake/write_version.cmake"], check=True)
        return re.search(r'return "([^"]+)"', file.read_text())[1].replace("-", ".")


def _metadata(version):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f"Requires-Dist: {name}; extra == '{extra}'" for name in names]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / "README.md").read_text()]
    scripts = "".join(f"{name} = {what}\n" for name, what in project["scripts"].items())
    return "\n".join(lines), f"[console_scripts]\n{scripts}"


def _digest(content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"sha256={digest},{len(content)}"


class _Wheel:
    """A zip file whose bytes depend on its content alone."""

    def __init__(self, file):
        self._zip = zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED)
        self._record = []

    def add(self, name, content, mode=0o644, recorded=True):
        entry = zipfile.ZipInfo(name, (2026, 1, 1, 0, 0, 0))
        entry.external_attr = (0o100000 | mode) << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        self._zip.writestr(entry, content)
        self._record.append(f"{name},{_digest(content) if recorded else ','}")

    def close(self, record):
        content = "\n".join([*self._record, f"{record},,", ""]).encode()
        self.add(record, content, recorded=False)
        self._zip.close()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """The hook of PEP 517: the folder with the metadata, for which nothing is built."""
    del config_settings
    version = _version()
    folder = pathlib.Path(metadata_directory) / f"chladni-{version}.dist-info"
    folder.mkdir()
    metadata, scripts = _metadata(version)
    (folder / "METADATA").write_text(metadata)
    (folder / "entry_points.txt").write_text(scripts)
    return folder.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The hook of PEP 517: the name of the wheel."""
    del metadata_directory
    build = _built(config_settings or {})
    machine = platform.machine()
    with tempfile.TemporaryDirectory() as stage:
        files = _staged(build, pathlib.Path(stage))
        version = _version()
        tags = f"{TAG}-{TAG}-linux_{machine}"
        name = f"chladni-{version}-{tags}.whl"
        info = f"chladni-{version}.dist-info"
        part = pathlib.Path(wheel_directory) / f"{name}.part"
        wheel = _Wheel(part)
        for path, file in files.items():
            wheel.add(path, file.read_bytes(), file.stat().st_mode & 0o755)
        metadata, scripts = _metadata(version)
        wheel.add(f"{info}/METADATA", metadata.encode())
        wheel.add(f"{info}/WHEEL", (f"Wheel-Version: 1.0\nGenerator: chladni_build\n"
                                    f"Root-Is-Purelib: false\nTag: {tags}\n").encode())
        wheel.add(f"{info}/entry_points.txt", scripts.encode())
        wheel.add(f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes())
        wheel.close(f"{info}/RECORD")
        part.rename(part.with_suffix(""))
    return name


def build_sdist(sdist_directory, config_settings=None):
    """The hook of PEP 517; there is no source package beside the repository."""
    raise SystemExit("chladni: there is no source distribution; use a checkout of the repository")
