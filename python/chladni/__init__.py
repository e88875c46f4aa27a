"""Chladni: modes of flexible stages, where to sense and push on them, their models from measured
responses, and what a simulation gets wrong. All values are in SI. See docs/reference/python.md.

    import chladni
    study = chladni.Study("stage.toml")
    modes = chladni.modes(study)
    modes.frequency_hz
"""
from ._chladni import (BestLayout, BestPair, Channel, Channels, ChladniWarning, Comparison,
                       DesignedExperiment, Diagnosis, Frf, Identified, InvalidInput,
                       MeasuredShapes, Mesh, ModeField, Modes, NumericalFailure, Observer,
                       OutOfResources, Placement, PlacementPlan, Places, Priors, Record, Recordings,
                       ResponseField, Result, Simulation, Sites, SpecimensDiagnosis, StateSpace,
                       Structure, Study, StudyField, WorkerDied, __version__, best_layouts,
                       best_pairs, blas_kernel, compare, diagnose, experiment, figure, gather,
                       identify, interpolate, interpolations, layout_score, mac, mode_field, modes,
                       observe, place, priors, read_frf, read_time, response_field, set_thread_count,
                       sweep, thread_count, write_frf, write_time)
from ._progress import Bar
from ._results import Cause, Experiment, Quantity, Sparse, simulate, to_pandas
from . import _copies

__all__ = [name for name in dir() if not name.startswith("_")] + ["__version__"]

# Names in messages and in help() are those that users import.
for _name in __all__:
    _value = globals()[_name]
    if isinstance(_value, type):
        _value.__module__ = "chladni"
del _name, _value
