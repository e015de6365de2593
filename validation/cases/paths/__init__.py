"""Cases on loading paths: independence of the increment, work and released energy, order and resumption."""
