

class Points(Strips):
    """Single rigid points in the place of the strips: where the profiles lie deepest in each other, or nearest.

    A point keeps its place for a time step: one that moves with the poses jumps where profiles have nearly the same
    curvature, and no head is then in balance. Its force goes with the power 3/2 of its depth, as that of Hertz.
    """

    def __init__(self, data):
        super().__init__(data)
        # force over the power 3/2 of the depth, N/m^1.5, and tangential over normal stiffness
        self.point, self.ratio = np.array(data['point_n_per_m1_5']), self.tangential / self.normal

    def begin_step(self, rim, head, strips, taken_up):
        """Begins a time step at these poses, with what friction some points have taken up (m)."""
        before = np.array(taken_up)
        super().begin_step(rim, head, [], [])
        place, tangent = self.in_wheel(self.rim, self.head, self.window)
        _, _, _, depth, _ = self.opposite(place, tangent, self.foot, 3)
        beside = range(-APART, APART + 1)
        padded = np.pad(depth, APART, constant_values=-np.inf)
        deepest = np.max([padded[APART + i:len(depth) + APART + i] for i in beside], axis=0)
        points = (depth > -NEARLY) & (depth == deepest)
        self.window, self.foot = self.window[points], self.foot[points]
        # a contact that rolls keeps what it has taken up
        for i in self.window if len(before) else ():
            nearest = np.abs(np.array(strips) - i).argmin()
            self.taken_up[i] = before[nearest] if abs(strips[nearest] - i) <= SAME else 0.0

    def stiffnesses(self, depth):
        """Forces (N) and stiffnesses (N/m) along the normal, and stiffnesses across it, at penetrations (m)."""
        stiffness = 1.5 * self.point[self.window] * np.sqrt(depth)
        return stiffness * depth / 1.5, stiffness, np.maximum(self.ratio[self.window] * stiffness, LEAST_TANGENTIAL)


APART = 10  # strips, the least distance of two points
SAME = 25  # strips, by which a point may move in a time step
NEARLY = 20e-6  # m, gap of a point that may touch in a time step
LEAST_TANGENTIAL = 1.0  # N/m, of a point that does not touch
