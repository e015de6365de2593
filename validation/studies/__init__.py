"""Studies: longer runs that answer one question about the suite itself."""
