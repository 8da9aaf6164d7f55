"""Problems of the public benchmark of model predictive control (mpc_qpbenchmark), as stage problems.

`python -m drawbar.benchmark.published` makes its three families from their definitions; with the folder of a copy of
its data it solves those files. Nothing of the data is part of drawbar.
"""
