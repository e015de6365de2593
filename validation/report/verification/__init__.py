"""What the verification report says of its rows: in one sentence, one figure, one budget each; equations and links."""
