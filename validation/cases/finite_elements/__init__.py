"""Cases of the finite element reference: against closed forms, then against the boundary elements."""
