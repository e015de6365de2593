"""Paths of few digits: from value to value of the control in leaps, events being brackets."""
