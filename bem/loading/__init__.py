"""What every loading path has, with adhesion or without: control, increments, interface, events, error estimates."""
