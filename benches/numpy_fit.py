"""The fit of benches/fit.rs in NumPy, on the matrix that it wrote: one thread, columns scaled alike."""

import os
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402  (the threads must be set first)

here = os.path.dirname(os.path.abspath(__file__))
matrix = np.fromfile(os.path.join(here, "..", "target", "fit_matrix.f64"), dtype="<f8").reshape(-1, 41)
columns, rhs = matrix[:, :40].copy(), matrix[:, 40].copy()
scaled = columns / np.linalg.norm(columns, axis=0)
times = []
for _ in range(7):
    start = time.perf_counter()
    np.linalg.lstsq(scaled, rhs, rcond=1e-10)
    times.append(time.perf_counter() - start)
median = sorted(times)[len(times) // 2]
print(f"numpy {np.__version__} lstsq, {columns.shape[0]} x {columns.shape[1]}: "
      f"{median * 1e3:.1f} ms, {columns.shape[0] / median / 1e6:.2f} M rows/s")
