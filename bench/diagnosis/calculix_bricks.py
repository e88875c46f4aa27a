"""Bodies of 20-node bricks: made, changed, solved by CalculiX (package calculix-ccx), written as STL."""
import hashlib
import os
import subprocess
import sys
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_matrix, load_npz, save_npz, triu
from scipy.sparse.linalg import splu

ALUMINIUM = (70e9, 0.33, 2700.0)
STEEL = (210e9, 0.3, 7850.0)


@dataclass
class Bricks:
    """Cells of a grid, some of them empty; coordinates in metres."""
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    filled: np.ndarray                      # i, j, k
    materials: list = field(default_factory=lambda: [ALUMINIUM])
    material: np.ndarray = None             # i, j, k: which
    masses: list = field(default_factory=list)   # (x, y, kg)
    taper: tuple = (0.0, 0.0)               # of the thickness, over half the length

    def __post_init__(self):
        self.material = np.zeros(self.filled.shape, int)


def cells(length, count):
    return np.linspace(-length / 2, length / 2, count + 1)


def plate(length, width, thickness, count, layers=1):
    shape = (count, max(1, round(count * width / length)), layers)
    return Bricks(cells(length, shape[0]), cells(width, shape[1]), np.linspace(-thickness, 0, layers + 1),
                  np.ones(shape, bool))


def halves(lines):
    both = np.empty(2 * len(lines) - 1)
    both[::2] = lines
    both[1::2] = 0.5 * (lines[1:] + lines[:-1])
    return both


# Corners, then the middles of edges, as C3D20R has them, on a lattice of half cells.
OFFSETS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
           (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]


def numbered(body):
    numbers = {}
    elements = []
    for cell in np.argwhere(body.filled):
        nodes = [tuple(int(v) for v in 2 * cell + np.array(o)) for o in OFFSETS]
        for node in nodes:
            numbers.setdefault(node, len(numbers) + 1)
        elements.append((body.material[tuple(cell)], [numbers[n] for n in nodes]))
    return numbers, elements


def places(body, numbers):
    x, y, z = halves(body.x), halves(body.y), halves(body.z)
    at = np.array([(x[i], y[j], z[k]) for i, j, k in numbers])
    u, v = at[:, 0] / np.abs(body.x).max(), at[:, 1] / np.abs(body.y).max()
    at[:, 2] = (at[:, 2] + 0.5 * (body.z[-1] - body.z[0])) * (1 + body.taper[0] * u + body.taper[1] * v)
    return at


def node_at(body, numbers, at, x, y):
    """The highest node of a vertical there; it must be one of the lattice."""
    apart = np.hypot(at[:, 0] - x, at[:, 1] - y)
    near = np.flatnonzero(apart < apart.min() + 1e-9)
    return int(near[np.argmax(at[near, 2])]) + 1


@dataclass
class Solved:
    """What CalculiX says of a body: modes of unit mass, and the matrices that they are of."""
    hz: np.ndarray
    shapes: np.ndarray                      # modes x nodes x 3
    at: np.ndarray
    numbers: dict
    stiffness: csc_matrix                   # three rows per node
    mass: csc_matrix


def deck(body, numbers, elements, at, frequency):
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{n}, {p[0]:.12g}, {p[1]:.12g}, {p[2]:.12g}" for n, p in zip(numbers.values(), at)]
    for m, (e, nu, rho) in enumerate(body.materials):
        lines.append(f"*ELEMENT, TYPE=C3D20R, ELSET=E{m}")
        for n, (which, nodes) in enumerate(elements):
            if which == m:
                lines.append(f"{n + 1}, " + ", ".join(map(str, nodes[:15])) + ",")
                lines.append("  " + ", ".join(map(str, nodes[15:])))
        lines += [f"*MATERIAL, NAME=M{m}", "*ELASTIC", f"{e:.12g}, {nu:.12g}", "*DENSITY", f"{rho:.12g}",
                  f"*SOLID SECTION, ELSET=E{m}, MATERIAL=M{m}"]
    number = len(elements)
    for n, (x, y, kg) in enumerate(body.masses):
        number += 1
        lines += [f"*ELEMENT, TYPE=MASS, ELSET=W{n}", f"{number}, {node_at(body, numbers, at, x, y)}",
                  f"*MASS, ELSET=W{n}", f"{kg:.12g}"]
    lines += ["*STEP", frequency, "*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def run(folder, text):
    (folder / "truth.inp").write_text(text)
    env = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    done = subprocess.run(["ccx", "truth"], cwd=folder, env=env, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{folder}: ccx failed: {done.stdout[-500:]}")


def modes_printed(folder, nodes):
    hz, shapes, current = [], [], None
    for line in (folder / "truth.dat").read_text().splitlines():
        words = line.split()
        if line.lstrip().startswith("displacements"):
            current = np.zeros((nodes, 3))
            shapes.append(current)
        elif current is not None and len(words) == 4:
            current[int(words[0]) - 1] = [float(w) for w in words[1:]]
        elif current is None and len(words) == 5 and words[0].isdigit():
            hz.append(float(words[3]))
    return np.array(hz[:len(shapes)]), np.array(shapes)


def matrix_stored(path, dofs, size):
    row, column, value = np.loadtxt(path, unpack=True)
    row, column = dofs[row.astype(int) - 1], dofs[column.astype(int) - 1]
    half = csc_matrix((value, (np.minimum(row, column), np.maximum(row, column))), shape=(size, size))
    return (half + triu(half, 1).T).tocsc()


def solved(body, folder, modes):
    """Modes and matrices by ccx; kept in the folder for the same input."""
    numbers, elements = numbered(body)
    at = places(body, numbers)
    asked = deck(body, numbers, elements, at, f"*FREQUENCY\n{modes}")
    name = "modes-" + hashlib.sha256(asked.encode()).hexdigest()[:12]
    kept = {what: folder / f"{name}{what}.npz" for what in ("", "-stiffness", "-mass")}
    if not all(path.exists() for path in kept.values()):
        folder.mkdir(parents=True, exist_ok=True)
        run(folder, asked)
        hz, shapes = modes_printed(folder, len(at))
        if len(hz) != modes or not hz[6] > 1.0:
            sys.exit(f"{folder}: ccx found {len(hz)} modes of {modes}, the seventh at {hz[6]} Hz")
        run(folder, asked.replace("*FREQUENCY", "*FREQUENCY, SOLVER=MATRIXSTORAGE"))
        numbers_of = np.array([line.split(".") for line in (folder / "truth.dof").read_text().split()], int)
        dofs = 3 * (numbers_of[:, 0] - 1) + numbers_of[:, 1] - 1
        save_npz(kept["-stiffness"], matrix_stored(folder / "truth.sti", dofs, 3 * len(at)))
        save_npz(kept["-mass"], matrix_stored(folder / "truth.mas", dofs, 3 * len(at)))
        np.savez(kept[""], hz=hz, shapes=shapes)
        for path in folder.glob("truth.[!j]*"):
            path.unlink()
    data = np.load(kept[""])
    return Solved(data["hz"], data["shapes"], at, numbers, load_npz(kept["-stiffness"]), load_npz(kept["-mass"]))


def row_at(body, modal, x, y, direction=(0.0, 0.0, 1.0)):
    """Of all degrees of freedom at (x, y) of the upper face: serendipity functions of the brick's face."""
    i = int(np.clip(np.searchsorted(body.x, x) - 1, 0, len(body.x) - 2))
    j = int(np.clip(np.searchsorted(body.y, y) - 1, 0, len(body.y) - 2))
    k = int(np.flatnonzero(body.filled[i, j]).max())
    s = 2 * (x - body.x[i]) / (body.x[i + 1] - body.x[i]) - 1
    t = 2 * (y - body.y[j]) / (body.y[j + 1] - body.y[j]) - 1
    row = np.zeros((len(modal.at), 3))
    for a in range(3):
        for b in range(3):
            if a == 1 and b == 1:
                continue
            p, q = a - 1, b - 1
            if p and q:
                w = 0.25 * (1 + s * p) * (1 + t * q) * (s * p + t * q - 1)
            elif p:
                w = 0.5 * (1 - t * t) * (1 + s * p)
            else:
                w = 0.5 * (1 - s * s) * (1 + t * q)
            row[modal.numbers[(2 * i + a, 2 * j + b, 2 * k + 2)] - 1] = w * np.array(direction)
    return row.ravel()


def seen(modal, rows):
    """Of all modes at these rows of degrees of freedom."""
    return rows @ modal.shapes.reshape(len(modal.hz), -1).T


def remainder(modal, rows, kept):
    """What all modes above those that are kept (seen there) add between these rows [m/N]: taken at half the
    first flexible frequency, from one solution of the whole."""
    w = 2 * np.pi * np.where(modal.hz < 1.0, 0.0, modal.hz)
    at = 0.5 * w[w > 0.0].min()
    factor = splu(modal.stiffness - at ** 2 * modal.mass, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01,
                  options={"SymmetricMode": True})
    whole = rows @ factor.solve(rows.T)
    return whole - kept @ ((1.0 / (w ** 2 - at ** 2))[:, None] * kept.T)


def with_region(body, inside, material, layers=None):
    body.materials = [*body.materials, material]
    x = 0.5 * (body.x[1:] + body.x[:-1])
    y = 0.5 * (body.y[1:] + body.y[:-1])
    where = inside(*np.meshgrid(x, y, indexing="ij"))
    for k in range(body.filled.shape[2]) if layers is None else layers:
        body.material[where, k] = len(body.materials) - 1
    return body


def with_block(body, low, high, height, material):
    """A block on the upper face, of bricks of its own, as one with it."""
    body.z = np.append(body.z, body.z[-1] + height)
    shape = body.filled.shape
    body.filled = np.concatenate([body.filled, np.zeros((*shape[:2], 1), bool)], axis=2)
    body.material = np.concatenate([body.material, np.zeros((*shape[:2], 1), int)], axis=2)
    body.materials = [*body.materials, material]
    x = 0.5 * (body.x[1:] + body.x[:-1])
    y = 0.5 * (body.y[1:] + body.y[:-1])
    over = ((x > low[0]) & (x < high[0]))[:, None] & ((y > low[1]) & (y < high[1]))[None, :]
    body.filled[over, -1] = True
    body.material[over, -1] = len(body.materials) - 1
    return body


def write_stl(body, path):
    """The surface of the filled cells, two triangles per face, in millimetres."""
    x, y, z = 1e3 * body.x, 1e3 * body.y, 1e3 * body.z
    def is_in(cell):
        return all(0 <= cell[a] < body.filled.shape[a] for a in range(3)) and body.filled[tuple(cell)]
    with open(path, "w", encoding="utf-8") as file:
        file.write("solid body\n")
        for cell in np.argwhere(body.filled):
            for axis in range(3):
                for side in (0, 1):
                    beside = cell.copy()
                    beside[axis] += 2 * side - 1
                    if is_in(beside):
                        continue
                    b, c = (axis + 1) % 3, (axis + 2) % 3
                    corners = []
                    for db, dc in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        node = cell.copy()
                        node[axis] += side
                        node[b] += db
                        node[c] += dc
                        corners.append((x[node[0]], y[node[1]], z[node[2]]))
                    if side == 0:
                        corners.reverse()
                    for tri in ((0, 1, 2), (0, 2, 3)):
                        file.write("facet normal 0 0 0\nouter loop\n")
                        for n in tri:
                            file.write("vertex {:.9g} {:.9g} {:.9g}\n".format(*corners[n]))
                        file.write("endloop\nendfacet\n")
        file.write("endsolid body\n")
