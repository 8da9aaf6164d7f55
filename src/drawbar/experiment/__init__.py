"""Experiments: many runs over cases and seeds on a Dask cluster, resumable, with tables and figures."""
