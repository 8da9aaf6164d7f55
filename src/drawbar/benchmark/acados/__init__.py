"""acados on the problems of drawbar's solvers: the same iteration from the same trajectory, timed in the same way."""
