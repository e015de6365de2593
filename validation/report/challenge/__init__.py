"""The page of a judgement, and the figures of the standings."""
