"""What cases of all groups share: how they are declared, scenes solved, and rows against one reference."""
