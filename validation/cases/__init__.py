"""Cases of the verification: pytest tests in test_*.py, their stored errors, and scenes that several share."""
