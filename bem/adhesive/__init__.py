"""Equilibria of the edges under adhesion: forces, Hessian, Newton along a branch, descent where it ends."""
