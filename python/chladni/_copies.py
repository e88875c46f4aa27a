"""How objects are copied and pickled."""
from . import _chladni
from ._chladni import Channel, Frf, Result, StateSpace, Study


def _made(kind, *state):
    """An object of the kind from what another one told of itself."""
    return kind._of_state(state)


def _reduced(self):
    return _made, (type(self), *self._state())


def _itself(self, *_memo):
    """What never changes is its own copy."""
    return self


def _refused(self):
    raise TypeError(f"cannot pickle a {type(self).__name__} of chladni")


for _one in vars(_chladni).values():
    if type(_one) is type(Frf):
        _one.__reduce__ = _refused
for _one in (Channel, Frf, StateSpace):
    _one.__reduce__ = _reduced
for _one in (Result, Study):
    _one.__copy__ = _one.__deepcopy__ = _itself
del _one
