"""A physical twin: tractor and trailer as a multibody on tyres, moved by MuJoCo."""
