"""The machines that drawbar can drive, behind one interface."""
