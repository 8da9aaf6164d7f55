"""Benchmarks of the compiled solvers in closed loop: phases, floor, bounds, growth, peers, and the whole step in C."""
