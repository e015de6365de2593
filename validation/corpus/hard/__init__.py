"""The hard cases of every code: what each asks for, what must come out, and the checks it must pass."""
