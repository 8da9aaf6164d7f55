"""Command-line interface: one file for each command. Commands import heavy modules within, so that help is quick."""
