"""A fill-reducing elimination order by geometric nested dissection."""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

LEAF = 60
"""Parts of this many nodes are not divided further."""


def nested_dissection(points: NDArray[np.float64], graph: sp.csr_matrix) -> NDArray[np.int64]:
    """Order of the nodes in which a symmetric matrix with this graph fills in little.

    Cuts the nodes at the median of that coordinate which gives the smallest
    separator, orders both halves before the separator, and repeats.

    ``points``: one row a node. ``graph``: sparse pattern between nodes.
    """
    side = np.full(len(points), -1, dtype=np.int8)

    def part(nodes: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        if len(nodes) <= LEAF:
            return [nodes]
        best: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]] | None = None
        for axis in range(points.shape[1]):
            value = points[nodes, axis]
            below = value <= np.median(value)
            left, right = nodes[below], nodes[~below]
            if len(right) < 0.2 * len(nodes):
                continue
            side[left], side[right] = 0, 1
            rows = graph[left]
            owner = np.repeat(np.arange(len(left)), np.diff(rows.indptr))
            cut = np.unique(owner[side[rows.indices] == 1])
            side[nodes] = -1
            if best is None or len(cut) < len(best[0]):
                best = (left[cut], np.delete(left, cut), right)
        if best is None:
            return [nodes]
        separator, left, right = best
        return [*part(left), *part(right), separator]

    return np.concatenate(part(np.arange(len(points))))
