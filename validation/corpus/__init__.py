"""What cases and studies both run: hard cases, scenes drawn at random, and curves of convergence."""
