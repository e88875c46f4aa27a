#!/usr/bin/env python3
"""Modes of the responses that `identification_study export CASE FILE.csv` writes, with those peers
that are installed: modal_fits.py FILE.csv ORDER FREQUENCY_HZ... (the true frequencies: a peer that
wants its poles picked gets them picked at their best). One line per peer and mode; a peer that is
not there is skipped aloud."""
import sys
import time

try:
    import numpy as np
except ImportError as missing:
    sys.exit(f"skipped: {missing}; apt-get install python3-numpy")


def responses(path):
    with open(path, encoding="ascii") as file:
        names = file.readline().strip().split(",")[1::2]
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    return table[:, 0], table[:, 1::2] + 1j * table[:, 2::2], names


def sdypy_lscf(frequency, value, order, picked):
    from sdypy import EMA
    model = EMA.Model(value.T, frequency, lower=frequency[0], upper=frequency[-1],
                      pol_order_high=order)
    model.get_poles(show_progress=False)
    model.select_closest_poles(list(picked))
    return np.asarray(model.nat_freq), np.asarray(model.nat_xi)


def scikit_rf_vector_fitting(frequency, value, order, _picked):
    import skrf
    count = value.shape[1]
    square = np.zeros((len(frequency), count, count), complex)
    # Accelerance: of receptances scikit-rf finds 7 of 17 modes.
    square[:, :, 0] = value * -(2.0 * np.pi * frequency[:, None]) ** 2
    network = skrf.Network(frequency=skrf.Frequency.from_f(frequency, unit="hz"), s=square)
    fit = skrf.VectorFitting(network)
    fit.vector_fit(n_poles_real=0, n_poles_cmplx=order)
    poles = fit.poles[np.abs(fit.poles.imag) > 0]
    return np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles)


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    frequency, value, _names = responses(sys.argv[1])
    order = int(sys.argv[2])
    picked = np.array([float(word) for word in sys.argv[3:]])
    for name, peer, package in (("sdypy-EMA LSCF", sdypy_lscf, "sdypy-EMA"),
                                ("scikit-rf VF", scikit_rf_vector_fitting, "scikit-rf")):
        start = time.process_time()
        try:
            found, damping = peer(frequency, value, order, picked)
        except ImportError as missing:
            print(f"{name}: skipped: {missing}; pip install {package}")
            continue
        seconds = time.process_time() - start
        for true in picked:
            nearest = np.argmin(np.abs(found - true))
            print(f"{name} {true:.6g} Hz: {found[nearest] / true - 1:+.2e} relative, "
                  f"damping ratio {damping[nearest]:.6f}, {seconds:.1f} CPU s")


if __name__ == "__main__":
    main()
