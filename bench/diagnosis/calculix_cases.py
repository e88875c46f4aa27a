"""What is measured on bodies of bricks: rigs, what is hidden in them, their responses, the studies of them."""
import gzip
from dataclasses import dataclass, field

import numpy as np

from calculix_bricks import (ALUMINIUM, STEEL, Bricks, plate, remainder, row_at, seen, with_block,
                             with_region)


@dataclass
class Rig:
    name: str
    geometry: str                # of the study
    sensors: list
    actuators: list
    high_hz: float = 900.0
    damping: float = 5e-3
    drawn: object = None         # makes the bricks of which an STL is drawn, where the study takes one


@dataclass
class Case:
    rig: Rig
    body: Bricks
    truth: list                                    # (effect, place or None, {size})
    moved: dict = field(default_factory=dict)      # sensor -> (dx, dy)
    tilted: dict = field(default_factory=dict)     # sensor -> direction
    swapped: tuple = ()
    hung: list = field(default_factory=list)       # (x, y, function of s: force per displacement)
    gains: dict = field(default_factory=dict)


def responses(case, modal, omega, seed):
    rng = np.random.default_rng(seed)
    rig = case.rig
    def rows(points, moved, tilted):
        found = []
        for n, (x, y) in enumerate(points):
            dx, dy = moved.get(n, (0.0, 0.0))
            ex, ey = rng.normal(0, 5e-4, 2)
            found.append(row_at(case.body, modal, x + dx + ex, y + dy + ey, tilted.get(n, (0.0, 0.0, 1.0))))
        return found
    places = [*rows(rig.sensors, case.moved, case.tilted), *rows(rig.actuators, {}, {})]
    out, act = slice(0, len(rig.sensors)), slice(len(rig.sensors), len(places))
    hang = slice(len(places), len(places) + len(case.hung))
    places = np.array(places + [row_at(case.body, modal, x, y) for x, y, _ in case.hung])
    kept = seen(modal, places)
    above = remainder(modal, places, kept)
    w = np.where(modal.hz < 1.0, 0.0, 2 * np.pi * modal.hz)
    zeta = rig.damping * np.exp(rng.normal(0, 0.2, len(w)))
    late = 1e-6 * rng.normal()
    gains_out, gains_in = (1 + rng.normal(0, 5e-3, len(side)) for side in (rig.sensors, rig.actuators))
    for n, gain in case.gains.items():
        gains_out[n] *= gain
    g = np.empty((len(omega), len(rig.sensors), len(rig.actuators)), complex)
    for n, one in enumerate(omega):
        s = 1j * one
        h = 1.0 / (w ** 2 + 2 * zeta * w * s + s * s)
        all_of = kept @ (h[:, None] * kept.T) + above
        g[n] = all_of[out, act]
        if case.hung:
            force = np.diag([1.0 / f(s) for _, _, f in case.hung])
            g[n] -= all_of[out, hang] @ np.linalg.solve(force + all_of[hang, hang], all_of[hang, act])
        g[n] *= np.outer(gains_out, gains_in) * np.exp(-s * late)
    if case.swapped:
        a, b = case.swapped
        g[:, [a, b]] = g[:, [b, a]]
    return g, rng


def write_measured(path, omega, g, noise, rng):
    std = noise * np.abs(g)
    g = g + std * (rng.normal(size=g.shape) + 1j * rng.normal(size=g.shape)) / np.sqrt(2)
    names = [f"{part}_s{i + 1}a{j + 1}" for i in range(g.shape[1]) for j in range(g.shape[2])
             for part in ("re", "im", "var")]
    table = np.empty((len(omega), 1 + 3 * g[0].size))
    table[:, 0] = omega / (2 * np.pi)
    flat, var = g.reshape(len(omega), -1), (std ** 2).reshape(len(omega), -1)
    table[:, 1::3], table[:, 2::3], table[:, 3::3] = flat.real, flat.imag, var
    with gzip.open(path, "wt") as file:
        file.write("freq_hz," + ",".join(names) + "\n")
        np.savetxt(file, table, delimiter=",", fmt="%.9g")


def study_text(rig):
    text = (f'title = "{rig.name}"\ngeometry = {rig.geometry}\n'
            'material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }\n'
            f"modes = {{ damping_ratio = {rig.damping} }}\n"
            '[measurement]\nfrf = "measured.csv.gz"\n[identification]\nunit = "m"\n'
            f'[diagnosis]\nband = ["20 Hz", "{rig.high_hz:g} Hz"]\n')
    for kind, name, points in (("sensor", "s", rig.sensors), ("actuator", "a", rig.actuators)):
        for n, (x, y) in enumerate(points):
            text += (f'[[{kind}]]\nname = "{name}{n + 1}"\nat = ["{1e3 * x:.9g} mm", "{1e3 * y:.9g} mm"]\n'
                     'direction = "z"\n' + ('quantity = "displacement"\n' if kind == "sensor" else ""))
    return text


def table_bricks(count=24):
    return plate(0.6, 0.6, 0.02, count)


def pocketed_bricks():
    # 4 x 4 pockets from below between ribs of 10 mm; 8 mm of face sheet stay.
    side, rib, count = 0.4, 0.01, 4
    pitch = (side - rib) / count
    lines = []
    for n in range(count):
        start = -side / 2 + n * pitch
        lines += [start, *np.linspace(start + rib, start + pitch, 5)[:-1]]
    lines += [side / 2 - rib, side / 2]
    lines = np.array(lines)
    z = np.array([-0.024, -0.016, -0.008, 0.0])
    filled = np.ones((len(lines) - 1, len(lines) - 1, 3), bool)
    middle = 0.5 * (lines[1:] + lines[:-1])
    phase = np.mod(middle + side / 2, pitch)
    inside = (phase > rib) & (middle < side / 2 - rib)
    filled[np.ix_(inside, inside, [0, 1])] = False
    return Bricks(lines, lines, z, filled)


def ell_bricks():
    body = plate(0.4, 0.4, 0.015, 20)
    middle = 0.5 * (body.x[1:] + body.x[:-1])
    body.filled[np.ix_(middle > 0, middle > 0)] = False
    return body


def stepped_bricks():
    # 480 x 320 x 18 mm; 30 mm in the middle third of the length.
    body = plate(0.48, 0.32, 0.03, 24, layers=2)
    body.z = np.array([-0.03, -0.018, 0.0])
    middle = 0.5 * (body.x[1:] + body.x[:-1])
    body.filled[np.abs(middle) > 0.08, :, 0] = False
    return body


SENSORS = [(-0.25, 0.25), (0.25, 0.25), (0.25, -0.25), (-0.25, -0.25)]
ACTUATORS = [(-0.18, 0.18), (0.18, 0.18), (0.18, -0.18), (-0.18, -0.18), (0.0, 0.0), (-0.12, 0.0),
             (0.12, 0.0), (0.0, 0.12), (0.0, -0.12), (-0.24, 0.0)]
TABLE = Rig("table", '{ plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }',
            SENSORS, ACTUATORS)
POCKETED = Rig("pocketed", '{ wafer_table = { length = "400 mm", width = "400 mm", height = "24 mm", '
               'pockets = [4, 4], face_sheet = "8 mm", rib = "10 mm" } }',
               [(-0.17, 0.17), (0.17, 0.17), (0.17, -0.17), (-0.17, -0.17)],
               [(-0.12, 0.12), (0.12, 0.13), (0.11, -0.12), (-0.13, -0.11), (0.01, 0.02), (-0.15, 0.01)],
               high_hz=1500.0)
ELL = Rig("ell", '{ file = "body.stl", unit = "mm" }',
          [(-0.17, 0.17), (-0.05, 0.16), (0.16, -0.05), (-0.16, -0.17), (0.17, -0.17)],
          [(-0.12, 0.12), (-0.1, -0.02), (0.03, -0.11), (0.11, -0.12), (-0.13, -0.11), (-0.02, -0.04)],
          high_hz=1200.0, drawn=ell_bricks)
STEPPED = Rig("stepped", '{ file = "body.stl", unit = "mm" }',
              [(-0.2, 0.13), (0.2, 0.14), (0.21, -0.12), (-0.19, -0.14)],
              [(-0.12, 0.1), (0.14, 0.08), (0.11, -0.12), (-0.13, -0.06), (0.01, 0.02), (-0.2, 0.01)],
              high_hz=1500.0, drawn=stepped_bricks)


def scaled(material, modulus=1.0, density=1.0):
    return (material[0] * modulus, material[1], material[2] * density)


def resonator(mass, hz, zeta):
    w = 2 * np.pi * hz
    def force(s):
        yields = w * w + 2 * zeta * w * s
        return mass * s * s * yields / (s * s + yields)
    return force


def all_cases():
    made = {}
    def add(name, rig, body, truth, **more):
        made[name] = Case(rig, body, truth, **more)
    def masses(body, *those):
        body.masses += those
        return body
    def spring(x, y, k):
        return {"hung": [(x, y, lambda s: k)]}
    def tapered(body, by):
        body.taper = by
        return body
    add("table_sound", TABLE, table_bricks(), [])
    add("table_mass", TABLE, masses(table_bricks(), (0.125, 0.075, 0.06)),
        [("point_mass", (0.125, 0.075), {"mass": 0.06})])
    add("table_spring", TABLE, table_bricks(),
        [("ground_spring", (0.15, -0.2), {"stiffness": 62e3})], **spring(0.15, -0.2, 62e3))
    add("table_swap_spring", TABLE, table_bricks(),
        [("swapped_sensors", None, {}), ("ground_spring", (-0.1, 0.225), {"stiffness": 140e3})],
        swapped=(0, 2), **spring(-0.1, 0.225, 140e3))
    add("table_taper", TABLE, tapered(table_bricks(), (0.03, 0.0)), [("thickness_field", None, {"u1": 0.03})])
    # Within a brick of 25 mm the face's functions are off by 0.4 % of the shapes above the band.
    add("table_moved", TABLE, table_bricks(48), [("sensor_position", None, {})], moved={1: (0.015, 0.0)})
    add("table_soft_strip", TABLE,
        with_region(table_bricks(), lambda x, y: (abs(x - 0.0875) < 0.0125) & (abs(y - 0.05) < 0.076),
                    scaled(ALUMINIUM, modulus=0.4)), [("local_stiffness", (0.0875, 0.05), {})])
    add("table_soft_disc", TABLE,
        with_region(table_bricks(), lambda x, y: np.hypot(x + 0.1, y - 0.1) < 0.06,
                    scaled(ALUMINIUM, modulus=0.5)), [("local_stiffness", (-0.1, 0.1), {"factor": -0.5})])
    add("table_cube", TABLE, with_block(table_bricks(), (0.1, 0.1), (0.125, 0.125), 0.0432, STEEL),
        [("mass_with_inertia", (0.1125, 0.1125), {"mass": 0.212})])
    add("table_bar", TABLE, with_block(table_bricks(), (-0.2, -0.05), (0.2, -0.025), 0.01, ALUMINIUM), None)
    add("table_damper", TABLE, table_bricks(), [("ground_damper", (0.2, 0.1), {"damping": 8.0})],
        hung=[(0.2, 0.1, lambda s: 8.0 * s)])
    add("table_resonator", TABLE, table_bricks(),
        [("resonator", (-0.05, -0.15), {"mass": 0.03, "frequency": 310.0})],
        hung=[(-0.05, -0.15, resonator(0.03, 310.0, 0.02))])
    add("table_gain", TABLE, table_bricks(), [("sensor_gain", None, {"gain": 0.93})], gains={2: 0.93})
    add("table_modulus", TABLE, with_region(table_bricks(), lambda x, y: x < 9, scaled(ALUMINIUM, 1.04)),
        [("modulus", None, {"relative": 0.04})])
    add("ell_sound", ELL, ell_bricks(), [])
    add("ell_mass", ELL, masses(ell_bricks(), (-0.05, 0.1, 0.05)), [("point_mass", (-0.05, 0.1), {"mass": 0.05})])
    add("ell_masses", ELL, masses(ell_bricks(), (-0.05, 0.1, 0.05), (0.12, -0.16, 0.09)),
        [("point_mass", (-0.05, 0.1), {"mass": 0.05}), ("point_mass", (0.12, -0.16), {"mass": 0.09})])
    add("ell_spring", ELL, ell_bricks(),
        [("ground_spring", (-0.12, -0.06), {"stiffness": 90e3})], **spring(-0.12, -0.06, 90e3))
    add("stepped_sound", STEPPED, stepped_bricks(), [])
    add("stepped_mass", STEPPED, masses(stepped_bricks(), (0.1, 0.08, 0.12)),
        [("point_mass", (0.1, 0.08), {"mass": 0.12})])
    add("stepped_density", STEPPED, with_region(stepped_bricks(), lambda x, y: x < 9, scaled(ALUMINIUM, 1, 1.03)),
        [("density", None, {"relative": 0.03})])
    add("pocketed_sound", POCKETED, pocketed_bricks(), [])
    line = pocketed_bricks().x[8]
    add("pocketed_mass", POCKETED, masses(pocketed_bricks(), (line, line, 0.199)),
        [("point_mass", (line, line), {"mass": 0.199})])
    add("pocketed_spring", POCKETED, pocketed_bricks(),
        [("ground_spring", (line, -line), {"stiffness": 140e3})], **spring(line, -line, 140e3))
    tilt = np.radians(9.0)
    add("pocketed_mass_tilt", POCKETED, masses(pocketed_bricks(), (-line, line, 0.12)),
        [("point_mass", (-line, line), {"mass": 0.12}), ("sensor_tilt", None, {})],
        tilted={1: (np.sin(tilt), 0.0, np.cos(tilt))})
    return made
