"""Finite element reference: a plane-strain periodic layer with JKR closure."""
