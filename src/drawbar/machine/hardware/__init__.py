"""The machine of iron: drivers that join transports and protocols."""
