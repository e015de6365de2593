"""Cases of the verification: pytest tests in test_*.py, their stored errors, and the scenes that several of them share."""
