"""Every other answer: closed forms, dense algebra, the paper's own method, FFT solvers, and the adapters to each code."""
