"""The vehicle: its parameters and its models, each declared once."""
