"""The WAV files of `chladni experiment`, read by Python's wave: an independent reader.

experiment_test.py CHLADNI"""
import csv
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import wave

program = pathlib.Path(sys.argv[1]).resolve()
study = pathlib.Path(__file__).resolve().parents[3] / "models/recordings/experiment.toml"
with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder) / "out"
    subprocess.run([program, "experiment", study, "-o", out, "--no-pictures", "--quiet"], check=True,
                   stdout=subprocess.DEVNULL)
    told = json.loads((out / "experiment.json").read_text())
    with wave.open(str(out / "excitation_r2_e1.wav")) as file:
        assert file.getframerate() == told["sample_rate_hz"], file.getframerate()
        assert (file.getnchannels(), file.getsampwidth()) == (2, 4), file.getparams()
        frames = file.getnframes()
        values = struct.unpack(f"<{2 * frames}i", file.readframes(frames))
    samples, settle, periods = told["samples"], told["settle_periods"], told["periods"]
    assert frames == samples * (settle + periods) + told["ramp_samples"], frames
    with open(out / "excitation.csv", newline="") as text:
        rows = [row for row in csv.DictReader(text)
                if row["realisation"] == "1" and row["experiment"] == "0"]
    assert len(rows) == samples, len(rows)
    names = [force["actuator"] for force in told["forces"]]
    scale = told["wav_full_scale"] / (2 ** 31 - 1)
    worst = 0.0
    for n in range(samples):  # the last recorded period
        for channel, name in enumerate(names):
            key = name if name in rows[n] else "in_" + name
            played = values[2 * (n + samples * (settle + periods - 1)) + channel] * scale
            worst = max(worst, abs(played - float(rows[n][key])))
    assert worst <= 0.51 * scale, (worst, scale)
    assert abs(values[0]) * scale < 1e-4 * told["wav_full_scale"], "it does not fade in"
    assert max(map(abs, values)) <= 2 ** 31 - 1
