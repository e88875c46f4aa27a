#!/usr/bin/env python3
"""Draws docs/pictures/loose_part.png, the picture of the README, from models/oat/with_loose_part.

loose_part.py CHLADNI FOLDER
The results go to FOLDER, and are taken from there if it has them. Needs python3-matplotlib. Everything that
is drawn is read from what `chladni diagnose` and `chladni modes` leave: responses are those of the state
spaces of the study and of extended.toml.
"""
import csv
import gzip
import json
import pathlib
import re
import struct
import subprocess
import sys
import zlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = pathlib.Path(__file__).resolve().parent
STUDY = HERE.parent.parent / "models/oat/with_loose_part"
TRUE_PLACE = (-0.154317, -0.221357)  # [m], as hidden_effects_study prints it (study.toml says how)
SENSOR, ACTUATOR = "s4", "a3"  # no fit saw this sensor
MEASURED, MODEL = "#222222", "#d1495b"


def appended_arrays(file):
    """Arrays of a .vtu by name: appended raw blocks, zlib, 64-bit headers."""
    head, _, rest = file.read_bytes().partition(b"<AppendedData")
    data = rest[rest.index(b"_") + 1 :]
    arrays = {}
    for kind, name, offset in re.findall(rb'type="(Float64|Int64)" Name="([^"]+)"[^>]*offset="(\d+)"', head):
        at = int(offset)
        (blocks,) = struct.unpack_from("<Q", data, at)
        sizes = struct.unpack_from(f"<{blocks}Q", data, at + 24)
        at, raw = at + 24 + 8 * blocks, b""
        for size in sizes:
            raw += zlib.decompress(data[at : at + size])
            at += size
        arrays[name.decode()] = np.frombuffer(raw, "<f8" if kind == b"Float64" else "<i8")
    return arrays


def measured():
    with gzip.open(STUDY / "measured.csv.gz", "rt") as file:
        rows = list(csv.reader(file))
    table = dict(zip(rows[0], np.array(rows[1:], float).T))
    pair = f"{SENSOR}{ACTUATOR}"
    return table["freq_hz"], np.hypot(table[f"re_{pair}"], table[f"im_{pair}"])


def response(model, frequency_hz):
    """|G| of a state space without delays, at these frequencies [m/N]."""
    a, b, c, d = (np.array(model[name]) for name in "ABCD")
    b, d = (m[:, [model["inputs"].index(ACTUATOR)]] for m in (b, d))
    c, d = (m[[model["outputs"].index(SENSOR)]] for m in (c, d))
    s = 2j * np.pi * frequency_hz[:, None, None]
    states = np.linalg.solve(s * np.eye(len(a)) - a, np.broadcast_to(b, (len(frequency_hz), *b.shape)))
    return abs(c @ states + d)[:, 0, 0]


def run(chladni, verb, study, out):
    """The folder with what a verb leaves, unless it is there from an earlier drawing."""
    command = [chladni, verb, study, "-o", out, "--no-pictures", "--quiet", "--allow-outside", STUDY]
    if not any(out.glob("*.json")):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return out


def simulated(chladni, text, folder):
    """The state space of a study's simulation."""
    study = folder.with_suffix(".toml")
    study.write_text(text + "\n[state_space]\n")
    model = run(chladni, "modes", study, folder) / "simulated_state_space.json"
    return json.loads(model.read_text())["continuous"]


def found(chladni, folder):
    """diagnosis.json, the cause map, and the simulations before and after."""
    diagnosed = run(chladni, "diagnose", STUDY / "study.toml", folder / "diagnosis")
    (folder / "measured.csv.gz").write_bytes((STUDY / "measured.csv.gz").read_bytes())
    before = simulated(chladni, (STUDY / "study.toml").read_text(), folder / "before")
    after = simulated(chladni, (diagnosed / "extended.toml").read_text(), folder / "after")
    return (json.loads((diagnosed / "diagnosis.json").read_text()),
            appended_arrays(diagnosed / "cause_map.vtu"), before, after)


def draw_responses(axes, frequency_hz, data, model, title, label):
    fine = np.linspace(frequency_hz[0], frequency_hz[-1], 2000)
    axes.semilogy(frequency_hz, data, color=MEASURED, linewidth=2.2, label="measured")
    axes.semilogy(fine, response(model, fine), color=MODEL, linewidth=1.3, linestyle=(0, (5, 1.5)),
                  label=label)
    axes.set(title=title, xlabel="frequency [Hz]", xlim=(fine[0], fine[-1]))
    axes.set_ylim(0.4 * data.min(), 2.5 * data.max())
    axes.legend(loc="upper right", frameon=False)


def draw_map(figure, axes, arrays, diagnosis):
    points = 1e3 * arrays["Points"].reshape(-1, 3)
    triangles = arrays["connectivity"].reshape(-1, 3)
    painted = axes.tripcolor(points[:, 0], points[:, 1], triangles, 100 * arrays["explained"],
                             shading="gouraud", cmap="viridis", vmin=0, vmax=100)
    place = diagnosis["causes"][0]["parameters"]
    axes.plot(*(1e3 * x for x in TRUE_PLACE), "o", markersize=17, markerfacecolor="none",
              markeredgecolor="white", markeredgewidth=2, label="true place")
    axes.plot(1e3 * place["u"]["value"], 1e3 * place["v"]["value"], "*", markersize=11, color="#ff3b30",
              markeredgecolor="white", markeredgewidth=0.5, label="found")
    axes.set(title="2  Where one thing would explain it", xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    axes.legend(loc="upper left", facecolor="#333333", labelcolor="white", framealpha=0.7)
    figure.colorbar(painted, ax=axes, label="of the misfit [%]", shrink=0.86)


def main():
    chladni, folder = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
    folder.mkdir(parents=True, exist_ok=True)
    diagnosis, arrays, before, after = found(chladni, folder)
    frequency_hz, data = measured()
    plt.rcParams.update({"font.size": 11, "axes.titlesize": 13, "axes.titleweight": "bold"})
    figure, axes = plt.subplots(1, 3, figsize=(16, 4.7), layout="constrained", width_ratios=[1, 0.95, 1])
    draw_responses(axes[0], frequency_hz, data, before, "1  What the simulation gets wrong", "simulated")
    axes[0].set_ylabel(f"{SENSOR} over {ACTUATOR} [m/N]")
    draw_map(figure, axes[1], arrays, diagnosis)
    draw_responses(axes[2], frequency_hz, data, after, "3  With the cause in the simulation",
                   "simulated, with it")
    figure.savefig(HERE / "loose_part.png", dpi=100, metadata={"Software": None})
    print(diagnosis["summary"])
    print("held out:", diagnosis["gain"]["held_out"], "noise", diagnosis["gain"]["held_out_noise_floor"])


if __name__ == "__main__":
    main()
