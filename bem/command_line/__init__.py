"""What the commands print, keep and lock."""
