"""Experiments and tuning: many seeded runs as tasks of a Dask cluster."""
