"""State and slip estimation: from noisy, incomplete measurements to what the controllers need."""
