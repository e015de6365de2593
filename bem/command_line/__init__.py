"""Output, checkpoints, locks and exit codes of the commands."""
