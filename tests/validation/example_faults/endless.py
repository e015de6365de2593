"""Cases that take too long, or only wait."""

import example_cases

from example_faults import case


def spin():
    while True:
        pass


CASES = (case("spins", spin), case("waits", example_cases.wait), case("sleeps", example_cases.dawdle))
