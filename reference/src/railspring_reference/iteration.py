"""Iterations that must reach their end: what stops before it is an error, never an answer."""


class NotConverged(RuntimeError):
    """An iteration without an answer.

    ``what``: which one, and under which load. ``residual``: the last change, in ``unit``; ``limit``: what would have
    ended it. ``points``: number of contact points that it ran over.
    """

    def __init__(
        self, what: str, iterations: int, residual: float, limit: float, unit: str, points: int
    ) -> None:
        super().__init__(
            f"{what}: no convergence in {iterations} iterations over {points} points "
            f"(last change {residual:.3g} {unit}, limit {limit:.3g} {unit})"
        )
        self.what, self.iterations, self.residual, self.points = what, iterations, residual, points


class BeyondCandidates(ValueError):
    """The contact needs more of the surface than was condensed."""
