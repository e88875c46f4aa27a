"""What results can do with other packages of Python, and how they look in a notebook."""
import dataclasses
import html
import importlib
import pathlib

import numpy as np

from . import _chladni
from ._chladni import (Comparison, DesignedExperiment, Diagnosis, Frf, Modes, Observer, Placement,
                       Result, StateSpace)


def _optional(name, package, purpose):
    try:
        return importlib.import_module(name)
    except ImportError as fault:
        raise ImportError(f"{purpose} needs the package {package}, which this Python has not: "
                          f"{fault}; pip install {package}") from None


# ---- equality

def _same(one, other):
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    return one == other


def _equal(self, other):
    """Field by field, arrays as a whole."""
    if type(other) is not type(self):
        return NotImplemented
    return all(_same(getattr(self, field.name), getattr(other, field.name))
               for field in dataclasses.fields(self))


# ---- sparse matrices

@dataclasses.dataclass(frozen=True, eq=False)
class Sparse:
    """A square symmetric matrix in compressed columns, where there is no SciPy. All of it is stored:
    column j has data[indptr[j]:indptr[j + 1]] in the rows indices[indptr[j]:indptr[j + 1]]."""
    data: np.ndarray
    indices: np.ndarray
    indptr: np.ndarray
    shape: tuple

    __eq__ = _equal

    def __hash__(self):
        return hash((self.shape, len(self.data)))


def _sparse(arrays):
    data, indices, indptr, size = arrays
    try:
        from scipy.sparse import csc_matrix
    except ImportError:
        return Sparse(data, indices, indptr, (size, size))
    return csc_matrix((data, indices, indptr), shape=(size, size))


def _stiffness(self):
    """K [N/m] on the free degrees of freedom, the whole symmetric matrix: of SciPy, or Sparse."""
    return _sparse(self._stiffness())


def _mass(self):
    """M [kg], likewise."""
    return _sparse(self._mass())


def _damping(self):
    """C [N s/m] of dashpots, likewise; None where there is none."""
    arrays = self._damping()
    return None if arrays is None else _sparse(arrays)


# ---- virtual experiments

@dataclasses.dataclass(frozen=True)
class Experiment:
    """What a virtual laboratory measured."""
    frf: Frf
    recordings: object  # Recordings where the study asks for them; else None


def simulate(study, *, progress=None, seed=None):
    """A virtual experiment: responses as a laboratory would measure them. study: a Study, its
    Modes, a file or a dict, with [experiment]."""
    return Experiment(*_chladni._simulate(study, progress, seed))


# ---- causes of a diagnosis

@dataclasses.dataclass(frozen=True)
class Quantity:
    """A number with its standard deviation and unit (SI)."""
    value: float
    std: float
    unit: str

    def __str__(self):
        unit = "" if self.unit == "1" else f" {self.unit}"
        known = self.std is not None and np.isfinite(self.std)
        return f"{self.value:.6g} +- {f'{self.std:.2g}' if known else 'unknown'}{unit}"


@dataclasses.dataclass(frozen=True, eq=False)
class Cause:
    """Something that the simulation gets wrong."""
    effect: str
    parameters: dict
    place: object  # [m], in the body's frame; None: it has no place
    channels: list
    option: object  # "g taken for m/s^2", or None
    probability: float
    log_evidence_gain: float
    share: float  # part of the excess misfit that it removes

    __eq__ = _equal

    def __hash__(self):
        return hash((self.effect, self.option, self.probability))

    def __str__(self):
        numbers = ", ".join(f"{name} {one}" for name, one in self.parameters.items())
        channels = " of " + ", ".join(self.channels) if self.channels else ""
        return f"{self.effect}{channels}: {numbers} (probability {self.probability:.3g})"


def _cause(told, place):
    parameters = {name: Quantity(one["value"], one["std"], one["unit"])
                  for name, one in told["parameters"].items()}
    return Cause(told["effect"], parameters, place, told["channels"], told.get("option"),
                 told["probability"], told["log_evidence_gain"], told["share"])


def _causes(self):
    """The causes of the best explanation."""
    return [_cause(told, place) for told, place in zip(self.to_dict()["causes"], self._places())]


def _part_of(key, text):
    def part(self):
        return self.to_dict()[key]
    part.__doc__ = text
    return property(part)


def _rows_of(*keys, text):
    """Rows that not every result of the kind has; then there are none."""
    def rows(self):
        told = self.to_dict()
        for key in keys:
            told = told.get(key, {})
        return list(told)
    rows.__doc__ = text
    return property(rows)


def _optional_part_of(key, text):
    """A part that not every result of the kind has; then it is None."""
    def part(self):
        return self.to_dict().get(key)
    part.__doc__ = text
    return property(part)


# ---- tables

def to_pandas(rows):
    """A table of dicts, such as placement.best or the variants of a sweep, as a DataFrame."""
    return _optional("pandas", "pandas", "to_pandas").DataFrame(list(rows))


def _modes_rows(self):
    """A dict for each mode, numbered from 1 with the rigid-body modes."""
    told = self.to_dict()
    columns = ("frequency_hz", "frequency_error_hz", "damping_ratio", "residual")
    rows = zip(*(told[name] for name in columns))
    return [{"mode": mode, **dict(zip(columns, row))} for mode, row in enumerate(rows, 1)]


def _table_to_pandas(self):
    """The table as a DataFrame."""
    return to_pandas(self.table)


# ---- python-control, PyVista

def _to_control(self):
    """A StateSpace of python-control; without that package the tuple (A, B, C, D), or (A, B, C, D,
    dt) of a discrete model, which scipy.signal takes. Neither knows delays: those of a discrete
    model become states, and a continuous model with delays is refused."""
    model = self
    if np.any(self.input_delay) or np.any(self.output_delay):
        if self.sample_time_s == 0:
            raise _chladni.InvalidInput(
                "the model has delays, which python-control and scipy.signal do not know; expected "
                "one with a sample rate, or with pade_order")
        model = self.with_delay_states()
    matrices = (model.A, model.B, model.C, model.D)
    discrete = (model.sample_time_s,) if model.sample_time_s else ()
    try:
        import control
    except ImportError:
        return matrices + discrete
    return control.ss(*matrices, *discrete, inputs=model.inputs, outputs=model.outputs,
                      states=model.states)


def _modes_to_control(self, **asked):
    """state_space(**asked) for python-control or scipy.signal."""
    return self.state_space(**asked).to_control()


def _filter_to_control(self):
    """The filter for python-control or scipy.signal, as StateSpace.to_control gives it."""
    return self.filter.to_control()


_VTK_TETS = {4: 10, 10: 24, 20: 71}  # VTK_TETRA, VTK_QUADRATIC_TETRA, VTK_LAGRANGE_TETRAHEDRON


def _to_pyvista(self):
    """The body as an UnstructuredGrid of PyVista, with a vector field for each mode."""
    pyvista = _optional("pyvista", "pyvista", "to_pyvista")
    cells = self.mesh.cells
    kinds = np.full(len(cells), _VTK_TETS[cells.shape[1]], np.uint8)
    sizes = np.full((len(cells), 1), cells.shape[1], cells.dtype)
    grid = pyvista.UnstructuredGrid(np.hstack([sizes, cells]).ravel(), kinds, self.mesh.nodes)
    for mode, frequency in enumerate(self.frequency_hz):
        grid.point_data[f"mode_{mode + 1:03d}_{frequency:.2f}Hz"] = self.shape(mode)
    return grid


def _surface_to_pyvista(self):
    """The surface as PolyData of PyVista, with the map of each criterion."""
    pyvista = _optional("pyvista", "pyvista", "to_pyvista")
    sizes = np.full((len(self.triangles), 1), 3, self.triangles.dtype)
    surface = pyvista.PolyData(self.points, np.hstack([sizes, self.triangles]).ravel())
    for name, score in self.maps.items():
        surface.point_data[name] = score
    return surface


def _shape(self, mode):
    """The shape of a mode, counted from 0, at the nodes: nodes x 3 [kg^-1/2], a view."""
    return self.shapes[:, mode].reshape(-1, 3)


# ---- how it looks in a notebook

def _page_in_frame(page, height=620):
    return (f'<iframe srcdoc="{html.escape(page, quote=True)}" sandbox="allow-scripts" '
            f'style="width: 100%; height: {height}px; border: 0"></iframe>')


def _repr_html(self):
    """The page of the result, with the viewer of the report; else its text."""
    page = self._page()
    return _page_in_frame(page) if page else f"<pre>{html.escape(str(self))}</pre>"


def _repr(self):
    return f"<chladni.{type(self).__name__} of \"{self.study.title or self.study.name}\">"


def _save_page(self, file):
    """Writes the page of the result to a file: HTML that needs no other file."""
    page = self._page()
    if not page:
        raise _chladni.InvalidInput(f"a result of the kind {type(self).__name__} has no page")
    pathlib.Path(file).write_text(page, encoding="utf-8")


Result._repr_html_ = _repr_html
Result.__repr__ = _repr
Modes.K = property(_stiffness)
Modes.M = property(_mass)
Modes.C = property(_damping)
Modes.shape = _shape
Modes.table = property(_modes_rows)
Modes.to_pandas = _table_to_pandas
Modes.to_control = _modes_to_control
Modes.to_pyvista = _to_pyvista
Modes.save_page = _save_page
Diagnosis.save_page = _save_page
Diagnosis.causes = property(_causes)
Diagnosis.verdict = _part_of("verdict", "\"named\", \"ambiguous\", \"partial\", \"unexplained\" or "
                                        "\"no_discrepancy\"")
Diagnosis.summary = _part_of("summary", "The verdict in a sentence.")
Diagnosis.gain = _part_of("gain", "Errors of the predicted responses before and after.")
Diagnosis.measure_next = _part_of("measure_next", "What would tell more.")
Diagnosis.proposals = _part_of("proposals", "Measurements that would tell more, best first.")
Diagnosis.alternatives = _part_of("alternatives", "Other explanations, with their causes.")
Diagnosis.detectable = _part_of("detectable", "Sizes that this experiment can find.")
Placement.best = _part_of("best", "The best places of one pair, best first.")
Placement.pairs = _part_of("pairs", "The pairs that are chosen together.")
Placement.layouts = _part_of("layouts", "The layouts of the study with their scores.")
Placement.optima = _part_of("optima", "The best layouts of sensors, with bounds.")
Placement.to_pyvista = _surface_to_pyvista
StateSpace.to_control = _to_control
Observer.table = _part_of("points", "A dict for each point.")
Observer.to_pandas = _table_to_pandas
Observer.to_control = _filter_to_control
Observer.noise = _part_of("noise", "What recordings teach of the noise: factors on what is stated.")
Observer.disturbances = _part_of("disturbances", "A dict for each.")
Observer.judges = _rows_of("replay", "judges", text="A dict for each held-out sensor: errors of the "
                           "replay, relative to its motion. Empty without recordings.")
Observer.judges_as_stated = _rows_of("replay_as_stated", "judges", text="Likewise with the noise as "
                                     "the study states it, where another was learned.")
Observer.loop = _optional_part_of("loop", "The loop on the estimate and that on the sensors; None: "
                                  "the study asks for none.")
Comparison.table = _part_of("modes", "A dict for each pair of a simulated and a measured mode.")
Comparison.to_pandas = _table_to_pandas
Comparison.responses = _rows_of("per_channel", text="A dict for each response, with its errors.")
Comparison.sensors = _rows_of("sensors", text="A dict for each sensor: error, gain, sign, CoMAC.")
Comparison.actuators = _rows_of("actuators", text="Likewise for each actuator.")
Comparison.relative_error = _optional_part_of("relative_error", "Over all responses and lines; None "
                                              "where modes were measured.")
Comparison.noise_floor = _optional_part_of("noise_floor", "The error of a perfect simulation; None: "
                                           "not known.")
DesignedExperiment.table = _part_of("modes", "A dict for each mode in the band, with its expected "
                                    "deviations.")
DesignedExperiment.to_pandas = _table_to_pandas
DesignedExperiment.verdict = _part_of("verdict", "What so long a measurement will tell.")
DesignedExperiment.kind = _part_of("kind", "\"multisine\" or \"hammer\"")
DesignedExperiment.coherence = _part_of("coherence", "A dict for each response: expected coherence.")
DesignedExperiment.forces = _rows_of("forces", text="A dict for each actuator; none with a hammer.")
