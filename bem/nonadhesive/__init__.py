"""Contact without adhesion: Newton on K = 0, the start on a grid, the path, and the last gaps before closure."""
