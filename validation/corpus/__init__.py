"""Scenes that cases and studies share: hard cases, scenes drawn at random, and curves of convergence."""
