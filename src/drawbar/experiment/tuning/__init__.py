"""Tuning: a search for weights and look-ahead over seeded runs, for the least error and the least steering effort."""
