    def on_wheel(self, along):
        """Points and angles of the wheel's profile at arc lengths: Hermite's cubics between the points of the table."""
        i = np.clip((along / self.spacing).astype(int), 0, len(self.wheel_angle) - 2)
        t = along / self.spacing - i
        before, after = (self.spacing * np.array([np.cos(a), np.sin(a)]) for a in self.wheel_angle[[i, i + 1]])
        chord = self.wheel[:, i + 1] - self.wheel[:, i]
        second, third = 3.0 * chord - 2.0 * before - after, before + after - 2.0 * chord
        point = self.wheel[:, i] + t * (before + t * (second + t * third))
        slope = before + t * (2.0 * second + 3.0 * t * third)
        return point, np.arctan2(slope[1], slope[0])

