"""Matrices of which only what may differ from zero is stored."""
from __future__ import annotations

from typing import NamedTuple

import numpy


class Sparse(NamedTuple):
    """A batch of matrices with one pattern: values[..., k] stands at (row[k], col[k]), row by row, as
    scipy.sparse.coo_matrix has them. `lower`: the matrix is symmetric, and only its lower triangle is stored."""
    values: numpy.ndarray  # (..., stored)
    row: numpy.ndarray  # (stored,)
    col: numpy.ndarray  # (stored,)
    shape: tuple[int, int]
    lower: bool

    @property
    def indptr(self) -> numpy.ndarray:
        """Of scipy.sparse.csr_matrix((values[k], col, indptr), shape): where each row begins, and the end."""
        return numpy.searchsorted(self.row, numpy.arange(self.shape[0] + 1)).astype(self.row.dtype)

    def toarray(self) -> numpy.ndarray:
        """(..., rows, columns)."""
        dense = numpy.zeros((*self.values.shape[:-1], *self.shape), self.values.dtype)
        dense[..., self.row, self.col] = self.values
        if self.lower:
            dense[..., self.col, self.row] = self.values
        return dense
