"""Rows of sensors that no fit saw, predicted from the same data by every way there is.

    held_out_rows.py CHLADNI [FOLDER_OF_MEASURED_DATA]

simulates the studies of docs/reference/identification_studies.md, takes each by the default path and
by the thesis' and prints the page's table. With a folder that has tue-beam-3x3/frf_3x3.csv the
measured beam is taken too, each of its sensors left out in turn.
"""
import csv
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MODELS = Path(__file__).resolve().parent.parent / "models"
METHODS = ["dynamic_residual", "thin_plate_spline", "squared_exponential"]
# Study, the one that simulates its data, what the thesis' path is told: modes, and its cut-off.
STUDIES = [
    ("beam/thesis_2x4", "beam/thesis_5x5", "modes = 5"),
    ("beam/thesis_5x3_without_3", "beam/thesis_5x3", "modes = 6"),
    ("beam/thesis_5x3_without_3_5", "beam/thesis_5x3", "modes = 6"),
    ("oat/identification/without_s4", "oat/identification/rig",
     "modes = 12\nrigid_body_modes = 3\ncut_off_db = 80"),
]


def call(chladni, verb, study, out, *options):
    done = subprocess.run([chladni, verb, str(study), "-o", str(out), "--quiet", *options],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{verb} {study}: {done.stderr}")


def responses(file):
    """Lines [Hz], and per column's name its values."""
    with open(file, encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    values = {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}
    return values.pop("freq_hz"), values


def errors(measured, predicted, sensors, low, high):
    """Per sensor: of the row over its size, and line by line (root mean square of the ratios); then
    what of it is noise, where the file states variances."""
    lines, there = measured
    at, said = predicted
    where = {f"{f:.6f}": k for k, f in enumerate(at)}
    result = {}
    for sensor in sensors:
        inputs = [n[len("re_" + sensor):] for n in said if n.startswith("re_" + sensor)]
        wrong, size, noise, ratios, floors = 0.0, 0.0, 0.0, [], []
        for k, f in enumerate(lines):
            if not low <= f <= high or f"{f:.6f}" not in where:
                continue
            m = where[f"{f:.6f}"]
            off = sum((there[p + sensor + u][k] - said[p + sensor + u][m]) ** 2
                      for u in inputs for p in ("re_", "im_"))
            here = sum(there[p + sensor + u][k] ** 2 for u in inputs for p in ("re_", "im_"))
            var = sum(there["var_" + sensor + u][k] for u in inputs
                      if "var_" + sensor + u in there)
            wrong, size, noise = wrong + off, size + here, noise + var
            ratios.append(off / here)
            floors.append(var / here)
        result[sensor] = (math.sqrt(wrong / size), math.sqrt(sum(ratios) / len(ratios)),
                          math.sqrt(noise / size), math.sqrt(sum(floors) / len(floors)))
    return result


def variant(study, target, path, method, hold_out=None):
    text = study.read_text(encoding="utf-8")
    text = re.sub(r"\n\[interpolation\][^\[]*(\[[^\]\n]*\]\n?)?$", "\n", text)
    if hold_out:
        text = re.sub(r"(\[measurement\]\nfrf[^\n]*\n)", rf'\1hold_out = ["{hold_out}"]\n', text)
    text = text.replace("[identification]\n", f"[identification]\n{path}\n")
    text = text.replace("stabilisation = 30\n", "")
    if 'method = "thesis"' in path:
        text = re.sub(r'\ndamping +=[^\n]*', "", text)  # it has real modes
    target.write_text(text + f'\n[interpolation]\nmethods = ["{method}"]\n', encoding="utf-8")


def rows_of(chladni, study, data, modes, folder, hold_out=None, options=()):
    """(path, method) -> errors per sensor."""
    result = {}
    band = re.search(r'\nband\s*= \["([\d.]+) Hz", "([\d.]+) Hz"\]', study.read_text())
    band = (float(band[1]), float(band[2])) if band else (0.0, math.inf)
    thesis = 'method = "thesis"\ngain = "thesis"\n' + modes
    for path, lines in (("default", ""), ("thesis", thesis)):
        for method in METHODS:
            file = study.parent / "variant.toml"
            variant(study, file, lines, method, hold_out)
            call(chladni, "interpolate", file, folder, "--no-pictures", *options)
            found = json.loads((folder / "interpolation.json").read_text(encoding="utf-8"))
            result[path, method] = errors(responses(data), responses(folder / "predicted.csv"),
                                          found["held_out"], *band)
    return result


def cells(values, which):
    return " | ".join(f"{100.0 * values[path, method][which]:.3g}"
                      for path in ("default", "thesis") for method in METHODS)


def show(name, found):
    for sensor in found["default", METHODS[0]]:
        per = {key: value[sensor] for key, value in found.items()}
        noise = per["default", METHODS[0]]
        print(f"| {name} | {sensor} | row | {cells(per, 0)} | {100.0 * noise[2]:.3g} |")
        print(f"| | | lines | {cells(per, 1)} | {100.0 * noise[3]:.3g} |", flush=True)


def main(chladni, data_folder=None):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        models = folder / "models"
        shutil.copytree(MODELS, models, ignore=shutil.ignore_patterns("*.csv"))
        for study, lab, modes in STUDIES:
            data = re.search(r'frf\s*= "(.*)"', (models / f"{study}.toml").read_text())[1]
            data = (models / study).parent / data
            if not data.exists():
                call(chladni, "simulate", models / f"{lab}.toml", folder / "lab")
            show(study, rows_of(chladni, models / f"{study}.toml", data, modes, folder / "out"))
        if not data_folder:
            return
        data = Path(data_folder).resolve() / "tue-beam-3x3" / "frf_3x3.csv"
        study = models / "beam" / "measured.toml"
        study.write_text(re.sub(r'frf = ".*"', f'frf = "{data}"', study.read_text()))
        for sensor in ("y1", "y3", "y5"):
            show("beam/measured", rows_of(chladni, study, data, "modes = 19", folder / "out", sensor,
                                          ("--allow-outside", str(data.parent))))


if __name__ == "__main__":
    main(*sys.argv[1:])
