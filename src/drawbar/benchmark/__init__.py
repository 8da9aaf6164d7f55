"""Measures the compiled solvers in closed loop: phases, floor, growth, and another route to the same answer."""
