"""The matrices of `benches/solve.rs` solved by LAPACK through numpy, on one thread.

python3 benches/numpy_lstsq.py
"""

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import statistics
import time

import numpy

for rows, columns in [(100_000, 40), (1_000_000, 40), (100_000, 100)]:
    i = numpy.arange(rows)
    a = numpy.cos(0.37 * (i[:, None] * numpy.arange(1, columns + 1)))
    b = numpy.sin(i)
    times = []
    for _ in range(7):
        start = time.perf_counter()
        x, squares, rank, _ = numpy.linalg.lstsq(a, b, rcond=1e-10)
        times.append(time.perf_counter() - start)
    seconds = statistics.median(times)
    print(
        f"{rows:8} x {columns:3}: {seconds:.3f} s (fastest {min(times):.3f}), "
        f"{rows / seconds / 1e6:.2f} million rows a second, rank {rank}, "
        f"residual {float(squares[0]) ** 0.5:.9f}"
    )
