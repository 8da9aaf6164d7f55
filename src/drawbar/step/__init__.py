"""The one control step: its order in C, and how Python builds it from a configuration."""
