# Numerics of the strips
WINDOW = 0.2e-3  # m, strips farther from the wheel than this at the beginning of a step take no part in it
DEEPEST = 1e-3  # m, what is deeper is not a contact
LEAST_COSINE = 0.3  # of the angle between profiles that face each other
SETTLED = 1e-5  # m, the last step to the point of the wheel opposite to a strip


def rotation(angle):
    """Rotation in the plane, from y to z."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def transport(arm):
    """Motion (y, z, phi) of a point of a rigid body, `arm` away from its reference point."""
    return np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]], [0.0, 0.0, 1.0]])


class Strips:
    """Strips between the profiles of head and wheel, with the friction that they have taken up.

    A pose is the displacement (y, z; m) and the rotation (rad) of a body: of the rim about the origin of the
    wheel's profile, of the head about the shear centre.
    """

    def __init__(self, data):
        # places of the rail, equally far apart, from the line of shear centres, with their tangents
        self.place = np.array([data['strip_y_m'], data['strip_z_m']])
        angle = np.array(data['strip_angle_rad'])
        self.tangent = np.array([np.cos(angle), np.sin(angle)])
        # stiffness of a strip along the normal and across it, N/m
        self.normal = np.array(data['strip_normal_pa']) * data['strip_width_m']
        self.tangential = np.array(data['strip_tangential_pa']) * data['strip_width_m']
        # the wheel's profile and its angle, at places that are equally far apart along it
        self.spacing = data['wheel_spacing_m']
        self.wheel = np.array([data['wheel_y_m'], data['wheel_z_m']])
        self.wheel_angle = np.array(data['wheel_angle_rad'])
        self.along = self.spacing * np.arange(len(self.wheel_angle))
        self.arm = np.array(WHEEL_ORIGIN)

    def begin_step(self, rim, head, strips, taken_up):
        """Begins a time step at these poses, with what friction some strips have taken up (m)."""
        self.rim, self.head = np.array(rim), np.array(head)
        self.taken_up = np.zeros(len(self.normal))
        self.taken_up[strips] = taken_up
        place, tangent = self.in_wheel(self.rim, self.head, slice(None))
        foot = np.interp(place[0], self.wheel[0], self.along)
        foot, _, _, depth, faces = self.opposite(place, tangent, foot, 6)
        self.window = np.flatnonzero(faces & (depth > -WINDOW) & (depth < DEEPEST))
        self.foot = foot[self.window]

    # ON_WHEEL
    def in_wheel(self, rim, head, strips):
        """Places and tangents of the rail at some strips, in the axes of the wheel's profile."""
        turn = rotation(head[2] - rim[2])
        by = rotation(-rim[2]) @ (head[:2] - rim[:2] - self.arm)
        return turn @ self.place[:, strips] + by[:, None], turn @ self.tangent[:, strips]

    def opposite(self, place, tangent, foot, iterations):
        """Where the normals of the rail meet the wheel, by Newton's method from the arc lengths `foot` on.

        Returns arc lengths, tangents of the wheel, cosines between both profiles, penetrations along the rail's
        normal, and whether the profiles face each other there.
        """
        for _ in range(iterations):
            point, angle = self.on_wheel(foot)
            on_wheel = np.array([np.cos(angle), np.sin(angle)])
            cosine = np.maximum((tangent * on_wheel).sum(0), LEAST_COSINE)
            step = np.clip((tangent * (place - point)).sum(0) / cosine, -5e-3, 5e-3)
            foot = np.clip(foot + step, 0.0, self.along[-1])
        point, _ = self.on_wheel(foot)
        depth = tangent[1] * (place - point)[0] - tangent[0] * (place - point)[1]
        return foot, on_wheel, cosine, depth, (cosine > LEAST_COSINE) & (np.abs(step) < SETTLED)

    def forces(self, rim, head):
        """Force and moment on the rim about its origin, minus their derivative by its motion, and the taken up."""
        strips = self.window
        place, tangent = self.in_wheel(rim, head, strips)
        _, (along_y, along_z), cosine, depth, faces = self.opposite(place, tangent, self.foot, 3)
        depth = np.where(faces & (depth < DEEPEST), np.maximum(depth, 0.0), 0.0)
        y, z = place
        # change of the penetration and of the tangential displacement with the motion of the rim
        deeper = np.array([-along_z, along_y, y * along_y + z * along_z]) / cosine
        aside = np.array([along_y, along_z, y * along_z - z * along_y])
        normal, pressed, tangential = self.stiffnesses(depth)
        limit = FRICTION * normal / cosine
        wanted = tangential * (self.taken_up[strips] + aside.T @ self.moved(rim, head))
        friction = np.clip(wanted, -limit, limit)
        force = -deeper @ normal - aside @ friction
        sticks = np.abs(wanted) < limit
        follows = np.where(sticks, 0.0, np.sign(wanted) * FRICTION * pressed / cosine)
        stiffness = (deeper * pressed + aside * follows) @ deeper.T + (aside * (tangential * sticks)) @ aside.T
        turn = np.eye(3)
        turn[:2, :2] = rotation(rim[2])
        return turn @ force, turn @ stiffness @ turn.T, friction / tangential

    def stiffnesses(self, depth):
        """Forces (N) and stiffnesses (N/m) along the normal, and stiffnesses across it, at penetrations (m)."""
        normal = self.normal[self.window]
        return normal * depth, normal * (depth > 0.0), self.tangential[self.window]

    def moved(self, rim, head):
        """Motion of the rim against the head in this time step, in the wheel's axes."""
        moved = rim - self.rim - transport(self.arm + rim[:2] - head[:2]) @ (head - self.head)
        moved[:2] = rotation(-rim[2]) @ moved[:2]
        return moved
