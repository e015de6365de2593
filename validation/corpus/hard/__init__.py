"""The hard cases of every code: what each asks for, what must come out, and the checks that any of them must pass."""
