"""References, in numbers alone: closed forms, dense algebra, an FFT solver of another group; none imports a code."""
