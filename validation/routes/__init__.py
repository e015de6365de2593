"""The routes: each code that answers, a function of a problem and one knob that returns an answer (harness/route.py).

One adapter for each code: the challenge calls it from behind its public door, the study of what accuracy costs times
it, and certified answers are compared with it.
"""
