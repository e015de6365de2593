"""Parts of every loading path, with adhesion or without: control, increments, interface, events, error estimates."""
