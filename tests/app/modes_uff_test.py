#!/usr/bin/env python3
"""modes.unv, identified.unv and mode_field.unv as another program reads them: by the columns of the
format's description, not by Chladni's reader.

modes_uff_test.py CHLADNI"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

PLATE = """title = "plate that hangs free"
geometry = { plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "10 mm", order = 2 }
modes = { count = 4, damping_ratio = 0.01, uff = "DATASET" }
identification = { uff = "DATASET", damping = "DAMPING" }
interpolation = { uff = "DATASET" }
measurement = { frf = "measured.csv" }
"""
CHANNELS = [("s1", -40, 20, 101), ("s2", 40, 20, 102), ("s3", 40, -20, None), ("s4", -40, -20, 104),
            ("s5", 0, 20, None)]


def fields(line, widths):
    """The columns of a line; a line that is shorter has empty ones, as Fortran reads it."""
    at, found = 0, []
    for width in widths:
        found.append(line[at:at + width].strip())
        at += width
    assert line[at:].strip() == "", f"{line!r} has more than {sum(widths)} columns"
    return found


def integers(line, count, width=10):
    return [int(word) for word in fields(line, [width] * count)]


def reals(line, count, width=13):
    return [float(word.replace("D", "E")) for word in fields(line, [width] * count)]


def datasets(text):
    """(number, lines) of each dataset between lines of I6 -1."""
    lines = text.split("\n")
    assert lines[-1] == "" and max(map(len, lines)) <= 80
    at = 0
    while at < len(lines) - 1:
        assert lines[at] == "    -1", f"line {at + 1}: {lines[at]!r}"
        end = lines.index("    -1", at + 1)
        yield integers(lines[at + 1], 1, 6)[0], lines[at + 2:end]
        at = end + 1


def shape_values(lines, is_complex):
    """Records of I10 and 6E13.5: a node, then three real or complex numbers."""
    shape = {}
    for node, values in zip(lines[::2], lines[1::2], strict=True):
        numbers = reals(values, 6 if is_complex else 3)
        shape[integers(node, 1)[0]] = ([complex(*numbers[i:i + 2]) for i in (0, 2, 4)] if is_complex
                                       else [complex(number) for number in numbers])
    return shape


def read_55(lines):
    model, analysis, kind, quantity, data, values = integers(lines[5], 6)
    assert (model, kind, quantity, values) == (1, 2, 8, 3)
    count_integers, count_reals, load_case, number = integers(lines[6], 4)
    numbers = reals(lines[7], count_reals)
    assert count_integers == 2 and load_case == 1
    if analysis == 2:
        assert data == 2 and count_reals == 4
        frequency, mass, damping, _hysteretic = numbers
    else:
        assert (analysis, data, count_reals) == (3, 5, 6)
        pole, mass = complex(*numbers[:2]), abs(complex(*numbers[2:4]))
        frequency = abs(pole) / 2 / math.pi
        damping = -pole.real / abs(pole) if pole else 0.0
    return {"number": number, "frequency": frequency, "damping": damping, "mass": mass,
            "shape": shape_values(lines[8:], data == 5)}


def read_2414(lines):
    assert integers(lines[2], 1) == [1]  # at nodes
    model, analysis, kind, quantity, data, values = integers(lines[8], 6)
    assert (model, kind, quantity, values) == (1, 2, 8, 3)
    assert (analysis, data) in ((2, 2), (3, 5))
    number = integers(lines[9], 8)[5]
    integers(lines[10], 8)
    _time, frequency, _eigenvalue, mass, damping, _hysteretic = reals(lines[11], 6)
    reals(lines[12], 6)
    return {"number": number, "frequency": frequency, "damping": damping, "mass": mass,
            "shape": shape_values(lines[13:], data == 5)}


def read(path):
    """Nodes, elements, trace lines and modes of a file, checked on the way."""
    found = {"nodes": {}, "elements": [], "lines": [], "modes": [], "numbers": []}
    for number, lines in datasets(path.read_text()):
        found["numbers"].append(number)
        if number == 151:
            assert len(lines) == 7 and lines[2].startswith("chladni 0.1.0"), lines
        elif number == 164:
            assert fields(lines[0], [10, 20, 10]) == ["1", "SI: metre, newton", "2"]
            assert reals(lines[1], 3, 25) == [1.0, 1.0, 1.0] and reals(lines[2], 1, 25) == [273.15]
        elif number == 15:
            for line in lines:
                node, _system, _displacements, _colour = integers(line[:40], 4)
                found["nodes"][node] = reals(line[40:], 3)
        elif number == 2411:
            for head, place in zip(lines[::2], lines[1::2], strict=True):
                assert "D" in place
                found["nodes"][integers(head, 4)[0]] = reals(place, 3, 25)
        elif number == 82:
            _number, count, _colour = integers(lines[0], 3)
            nodes = [int(word) for line in lines[2:] for word in line.split()]
            assert count == len(nodes) <= 125
            found["lines"].append(nodes)
        elif number == 2412:
            for head, corners in zip(lines[::2], lines[1::2], strict=True):
                assert integers(head, 6)[1] == 91 and integers(head, 6)[5] == 3
                found["elements"].append(integers(corners, 3))
        elif number in (55, 2414):
            found["modes"].append(read_55(lines) if number == 55 else read_2414(lines))
        else:
            raise AssertionError(f"dataset {number}")
    return found


def close(a, b, size, digits=1e-6):
    return abs(a - b) <= digits * size


def check_body(found, result):
    """Against modes.json: frequencies, and the values at the sensors, which are at nodes."""
    assert [mode["number"] for mode in found["modes"]] == list(range(1, 11))
    for mode, frequency in zip(found["modes"], result["frequency_hz"], strict=True):
        assert close(mode["frequency"], frequency, frequency, 1e-8) and mode["mass"] == 1.0
        assert mode["shape"].keys() == found["nodes"].keys()
    nodes = {node for corners in found["elements"] for node in corners}
    assert nodes == found["nodes"].keys()
    # A closed surface: each edge belongs to two triangles, once in either direction.
    edges = [(t[i], t[(i + 1) % 3]) for t in found["elements"] for i in range(3)]
    assert len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)
    for name, x, y, _node in CHANNELS:
        here = [node for node, at in found["nodes"].items()
                if math.dist(at, (1e-3 * x, 1e-3 * y, 0.0)) < 1e-9]
        assert len(here) == 1, name
        values = result["sensors"][name]
        largest = max(map(abs, values))
        for mode, value in zip(found["modes"], values, strict=True):
            assert close(mode["shape"][here[0]][2], value, largest), (name, mode, value)


def check_channels(found, result, is_complex):
    """Against identified.json: channels along z, those without a node numbered from 1."""
    numbers = {"s1": 101, "s2": 102, "s3": 1, "s4": 104, "s5": 2}
    assert found["nodes"].keys() == set(numbers.values())
    assert sum(len(line) for line in found["lines"]) == 3 * (len(numbers) - 1)
    shapes = result["shapes"]
    imaginary = result["imaginary_shapes"]["value"] if is_complex else None
    for name, x, y, _node in CHANNELS:
        assert math.dist(found["nodes"][numbers[name]], (1e-3 * x, 1e-3 * y, 0.0)) < 1e-9
        row = shapes["channels"].index(name)
        for m, mode in enumerate(found["modes"]):
            value = complex(shapes["value"][row][m], imaginary[row][m] if is_complex else 0.0)
            largest = max(abs(values[m]) for values in shapes["value"])
            assert close(mode["shape"][numbers[name]][2], value, largest)
            assert mode["shape"][numbers[name]][:2] == [0.0, 0.0]
    for mode, known in zip(found["modes"], result["modes"], strict=True):
        assert close(mode["frequency"], known["frequency_hz"], known["frequency_hz"], 1e-8)
        assert close(mode["damping"], known["damping_ratio"], 1.0, 1e-8)
        assert (mode["mass"] > 0.0) != known["rigid"] or mode["mass"] >= 0.0


def write_responses(result, path):
    """The responses of the simulated modes, with a little noise."""
    draw = random.Random(5)
    names = [channel[0] for channel in CHANNELS]
    lines = ["freq_hz," + ",".join(f"re_{name}/a1,im_{name}/a1" for name in names)]
    for k in range(400):
        hertz = 1500.0 + 20.0 * k
        omega = 2 * math.pi * hertz
        row = [hertz]
        for name in names:
            value = 0.0
            for m, frequency in enumerate(result["frequency_hz"]):
                own = 2 * math.pi * frequency
                shapes = result["sensors"][name][m] * result["actuators"]["a1"][m]
                damping = result["damping_ratio"][m]
                value += shapes / (own**2 - omega**2 + 2j * damping * own * omega)
            value *= 1.0 + 1e-4 * complex(draw.gauss(0, 1), draw.gauss(0, 1))
            row += [value.real, value.imag]
        lines.append(",".join(map(repr, row)))
    path.write_text("\n".join(lines) + "\n")


def check_with_pyuff(path, found):
    """Against pyuff, where it is installed."""
    try:
        import pyuff
    except ImportError:
        return
    sets = [each for each in pyuff.UFF(str(path)).read_sets() if each["type"] in (55, 2414)]
    assert len(sets) == len(found["modes"])
    for each, mode in zip(sets, found["modes"], strict=True):
        for node, z in zip(each["node_nums"], each["r3"], strict=True):
            assert close(complex(z), mode["shape"][int(node)][2], 1.0)


def main():
    chladni = sys.argv[1]
    channels = "".join(f'[[sensor]]\nname = "{name}"\nat = ["{x} mm", "{y} mm"]\ndirection = "z"\n' +
                       (f"node = {node}\n" if node else "") for name, x, y, node in CHANNELS)
    actuator = '[[actuator]]\nname = "a1"\nat = ["-40 mm", "20 mm"]\ndirection = "z"\n'
    for dataset, damping in (("55", "modal"), ("2414", "general")):
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            text = PLATE.replace("DATASET", dataset).replace("DAMPING", damping)
            (work / "plate.toml").write_text(text + channels + actuator)

            def run(verb, *more):
                end = subprocess.run([chladni, verb, "plate.toml", "--no-pictures", "-o", "out", *more],
                                     cwd=work, capture_output=True, text=True)
                assert end.returncode == 0, end.stderr + end.stdout

            (work / "measured.csv").write_text("freq_hz,re_s1/a1,im_s1/a1\n1,0,0\n")
            run("modes")
            write_responses(json.loads((work / "out/modes.json").read_text()), work / "measured.csv")
            run("interpolate")
            of = {name: read(work / "out" / f"{name}.unv")
                  for name in ("modes", "identified", "mode_field")}
            body = [151, 164, 2411, 2412]
            assert of["modes"]["numbers"] == body + [int(dataset)] * 10
            check_body(of["modes"], json.loads((work / "out/modes.json").read_text()))
            identified = json.loads((work / "out/identified.json").read_text())
            assert of["identified"]["numbers"][:4] == [151, 164, 15, 82]
            check_channels(of["identified"], identified, damping == "general")
            # The interpolated shapes pass near the measured ones, along z alone.
            field = of["mode_field"]
            assert field["numbers"][:4] == body and field["modes"]
            for mode in field["modes"]:
                assert all(value[:2] == [0.0, 0.0] for value in mode["shape"].values())
                assert mode["shape"].keys() == field["nodes"].keys()
            for name in of:
                check_with_pyuff(work / "out" / f"{name}.unv", of[name])
            # Without the key an older file goes, and nothing else is left.
            (work / "plate.toml").write_text(text.replace(f'uff = "{dataset}"', 'uff = "none"') +
                                             channels + actuator)
            run("modes")
            assert not (work / "out/modes.unv").exists()
            listing = subprocess.run([chladni, "check", str(work / "out/identified.unv")],
                                     capture_output=True, text=True)
            assert listing.returncode == 0, listing.stderr
            assert "modes, 5 nodes with places, 1 trace lines" in listing.stdout, listing.stdout


if __name__ == "__main__":
    main()
