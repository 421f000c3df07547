"""Solves recorded bound-constrained quadratic programs with PETSc TAO, to tell whether ours solves them right.

Usage: /usr/bin/python3 petsc_oracle.py OUTPUT.json PROBLEM.h5...

Each problem (format: continuum/qp/problem_file.h) is solved by gpcg and by bntr, two methods that share little with each
other and nothing with MPRGP. OUTPUT.json: { "PROBLEM.h5": { "gpcg": SOLUTION, "bntr": SOLUTION } }, where a SOLUTION
holds x, objective and iterations.
"""

import glob
import json
import os
import sys

# Where Debian's python3-petsc4py-real puts it, which is not on Python's own path.
sys.path[:0] = sorted(glob.glob("/usr/lib/petscdir/petsc*/*-real/lib/python3/dist-packages"))
# Without these Open MPI looks for ssh, and will not start as root.
os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")

import h5py  # noqa: E402
import numpy as np  # noqa: E402
import petsc4py  # noqa: E402

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402

METHODS = ("gpcg", "bntr")
RELATIVE_TOLERANCE = 1e-13  # of the gradient's norm at the start
# gpcg stops making progress where its decrease of the objective is lost in round-off; its last step, on the right face,
# is as good as its linear solver.
LINEAR_TOLERANCE = 1e-12
MAX_ITERATIONS = 100


def read_problem(path):
    with h5py.File(path, "r") as file:
        if (file.attrs["format"], file.attrs["version"], file.attrs["kind"]) != (b"talus-qp", 1, b"bound"):
            raise SystemExit(f"{path}: not a bound problem of version 1")
        matrix = {key: file["matrix"][key][:] for key in ("offsets", "rows", "values")}
        return matrix, {key: file[key][:] for key in ("linear", "lower", "upper", "start")}


def scaled(matrix, arrays):
    """The problem in variables x / scale, with a unit diagonal and a largest linear term of 1: TAO's trust regions and
    tolerances suppose numbers of order 1."""
    columns = np.repeat(np.arange(len(arrays["linear"])), np.diff(matrix["offsets"]))
    on_diagonal = matrix["rows"] == columns
    diagonal = np.zeros(len(arrays["linear"]))
    diagonal[columns[on_diagonal]] = matrix["values"][on_diagonal]
    root = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    size = np.abs(root * arrays["linear"]).max()
    scale = size * root
    scaled_matrix = dict(matrix, values=root[matrix["rows"]] * matrix["values"] * root[columns])
    scaled_arrays = {key: arrays[key] / scale for key in ("lower", "upper", "start")}
    return scale, scaled_matrix, dict(scaled_arrays, linear=root * arrays["linear"] / size)


def vector(values):
    # PETSc's infinity is finite, and larger bounds overflow in its steps.
    return PETSc.Vec().createWithArray(np.clip(values, -PETSc.INFINITY, PETSc.INFINITY).copy())


def sparse(matrix):
    # Compressed columns of a symmetric matrix are its compressed rows.
    n = len(matrix["offsets"]) - 1
    csr = (matrix["offsets"].astype(PETSc.IntType), matrix["rows"].astype(PETSc.IntType), matrix["values"])
    return PETSc.Mat().createAIJ((n, n), csr=csr)


def minimise(method, matrix, arrays):
    hessian, linear = sparse(matrix), vector(arrays["linear"])
    x = vector(np.clip(arrays["start"], arrays["lower"], arrays["upper"]))

    def objective_and_gradient(_tao, at, gradient):
        hessian.mult(at, gradient)
        value = 0.5 * at.dot(gradient) + linear.dot(at)
        gradient.axpy(1.0, linear)
        return value

    tao = PETSc.TAO().create()
    tao.setType(method)
    tao.setObjectiveGradient(objective_and_gradient, None)
    tao.setHessian(lambda _tao, _at, _hessian, _preconditioner: None, hessian)
    tao.setVariableBounds(vector(arrays["lower"]), vector(arrays["upper"]))
    tao.setTolerances(gatol=0.0, grtol=0.0, gttol=RELATIVE_TOLERANCE)
    tao.setMaximumIterations(MAX_ITERATIONS)
    tao.getKSP().setTolerances(rtol=LINEAR_TOLERANCE, max_it=10 * x.size)
    tao.solve(x)
    return x.array.copy(), tao.getIterationNumber()


def solve(method, path):
    matrix, arrays = read_problem(path)
    scale, scaled_matrix, scaled_arrays = scaled(matrix, arrays)
    y, iterations = minimise(method, scaled_matrix, scaled_arrays)
    # Scaling back may miss a bound by a rounding.
    x = np.where(y <= scaled_arrays["lower"], arrays["lower"],
                 np.where(y >= scaled_arrays["upper"], arrays["upper"], scale * y))
    at, product = vector(x), vector(x)
    sparse(matrix).mult(at, product)
    return {
        "x": x.tolist(),
        "objective": float(0.5 * x @ product.array + arrays["linear"] @ x),
        "iterations": iterations,
    }


def main(output, *problems):
    solutions = {path: {method: solve(method, path) for method in METHODS} for path in problems}
    with open(output, "w", encoding="utf-8") as file:
        json.dump(solutions, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
