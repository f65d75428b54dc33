"""The other side of benches/ratios.rs: numpy's least squares on the matrix that it wrote, polars on its log.

ratios.py MATRIX LOG COLUMNS THREADS TIMES prints the fastest time of each, s.
"""

import os
import sys
import time

matrix_file, log_file = sys.argv[1:3]
columns, threads, times = (int(word) for word in sys.argv[3:6])
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "POLARS_MAX_THREADS"):
    os.environ[name] = str(threads)

import numpy as np  # noqa: E402  (the threads must be set first)
import polars as pl  # noqa: E402


def fastest(work):
    """The shortest time that the work took, s."""
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return min(taken)


matrix = np.fromfile(matrix_file, dtype="<f8").reshape(-1, columns + 1)
unscaled, rhs = matrix[:, :columns].copy(), matrix[:, columns].copy()
scaled = unscaled / np.linalg.norm(unscaled, axis=0)
print("lstsq", fastest(lambda: np.linalg.lstsq(scaled, rhs, rcond=1e-10)))
print("polars", fastest(lambda: pl.read_csv(log_file)))
