#!/usr/bin/env python3
"""Length scales of twelve shapes by marginal likelihood with scikit-learn, on the points and shapes
of bench/priors/learning_bench.cpp: gaussian_process.py N [MODES]. One JSON line."""
import json
import math
import resource
import sys

try:
    import numpy as np
    import sklearn
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
except ImportError as missing:
    sys.exit(f"skipped: {missing}; apt-get install python3-sklearn")


def sample(count):
    i = np.arange(count)
    u = np.mod(0.5 + i * 0.7548776662466927, 1.0)
    v = np.mod(0.5 + i * 0.5698402909980532, 1.0)
    return np.column_stack([0.6 * u - 0.3, 0.6 * v - 0.3])


def shape(points, m):
    kx, ky = math.pi / 0.6 * (1 + m % 4), math.pi / 0.6 * (1 + m // 4)
    return 2.0 * np.cos(kx * (points[:, 0] + 0.3)) * np.cos(ky * (points[:, 1] + 0.3))


def main():
    count = int(sys.argv[1])
    modes = int(sys.argv[2]) if len(sys.argv) > 2 else 12
    points = sample(count)
    lengths, sigmas = [], []
    start = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    for m in range(modes):
        # sigma^2 (k + 1e-8), the same model as ours.
        kernel = ConstantKernel(1.0, (1e-4, 1e6)) * (RBF(0.1, (5e-3, 5.0)) +
                                                     WhiteKernel(1e-8, "fixed"))
        learner = GaussianProcessRegressor(kernel, alpha=0.0, n_restarts_optimizer=0)
        learner.fit(points, shape(points, m))
        lengths.append(float(learner.kernel_.k2.k1.length_scale))
        sigmas.append(math.sqrt(learner.kernel_.k1.constant_value))
    took = resource.getrusage(resource.RUSAGE_SELF).ru_utime - start
    print(json.dumps({"scikit-learn": sklearn.__version__, "samples": count, "modes": modes,
                      "cpu_seconds": round(took, 2), "length_m": lengths, "sigma": sigmas}))


if __name__ == "__main__":
    main()
