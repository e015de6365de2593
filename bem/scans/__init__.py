"""Measured profiles: from a file to the uniform samples of a period, in m."""
