"""Measures the compiled solvers in closed loop: phases, floor, bounds, growth, their peers, and the whole step in C."""
