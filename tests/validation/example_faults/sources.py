"""What the example's faults change."""


def right(x):
    return x


def never():
    return 0.0


class Thing:
    def double(self, n):
        return 2.0 * n


FUNCTIONS = {"right": right}
