"""The tube: how far errors can take each body from its nominal motion, and what that leaves of the bounds."""
