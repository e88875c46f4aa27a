"""Who is told of the progress of a long step, and of its warnings."""
import pathlib
import sys
import time
import warnings

from ._chladni import ChladniWarning

_QUIET = 0.5  # [s]: a step that takes less shows no bar
_WIDTH = 24


def _on_terminal():
    """Whether standard error is a terminal. It may be missing, or an object that only writes."""
    asked = getattr(sys.stderr, "isatty", None)
    return asked is not None and asked()


def _in_notebook():
    shell = sys.modules.get("IPython")
    return shell is not None and type(shell.get_ipython()).__name__ == "ZMQInteractiveShell"


class Bar:
    """One line of text that is written over: the step, how much of it is done, and the time."""

    def __init__(self, stream=None):
        self._stream = stream or sys.stderr
        self._start = time.monotonic()
        self._drawn = 0  # letters

    def __call__(self, step, fraction):
        seconds = time.monotonic() - self._start
        if seconds < _QUIET:
            return
        line = f"{step} {seconds:.0f} s"
        if fraction is not None:
            full = round(_WIDTH * min(max(fraction, 0.0), 1.0))
            line = f"{step} [{'#' * full}{'.' * (_WIDTH - full)}] {100 * fraction:3.0f} % {seconds:.0f} s"
        self._write("\r" + line.ljust(self._drawn))
        self._drawn = len(line)

    def close(self):
        """Clears the line."""
        if self._drawn:
            self._write("\r" + " " * self._drawn + "\r")
        self._drawn = 0

    def _write(self, text):
        if self._stream is None:
            return
        self._stream.write(text)
        getattr(self._stream, "flush", lambda: None)()


def listener(progress):
    """What a step tells of its progress: nothing if False; a bar if None, in a notebook and on a
    terminal; else the function that was given."""
    if progress is None:
        return Bar() if _in_notebook() or _on_terminal() else None
    if progress is False:
        return None
    if progress is True:
        return Bar()
    if not callable(progress):
        raise TypeError(f"progress is {progress!r}; expected a function of the step's name and the "
                        "part that is done (or None), or False")
    return progress


def warn(texts):
    """Warns at the line outside this package that asked for the step."""
    package = str(pathlib.Path(__file__).parent)
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(package):
        level, frame = level + 1, frame.f_back
    for text in texts:
        warnings.warn(text, ChladniWarning, stacklevel=level)
