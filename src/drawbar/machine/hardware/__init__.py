"""Real machines: what each device is told in the configuration, and the drivers that join protocols and transports."""
