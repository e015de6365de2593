"""The line-contact challenge: problems with certified answers, and a judge for any solver."""
