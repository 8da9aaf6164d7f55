"""Finding weights and look-ahead: a search over seeded runs for the least error and the least steering effort."""
