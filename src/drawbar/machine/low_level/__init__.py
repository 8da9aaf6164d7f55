"""The low level: position loops of valves and motors, the speed cascade, and a simulated valve to try them on."""
