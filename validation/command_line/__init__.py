"""The command `linecontact`: solver and harness behind one door."""
