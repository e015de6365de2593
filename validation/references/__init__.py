"""Every other answer: closed forms, dense algebra, the paper's method, FFT solvers, and the adapters to each code."""
