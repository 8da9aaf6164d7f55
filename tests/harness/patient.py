"""Times of a drive on a busy test machine; the rehearsal and the gate's tests prove those of a real one."""

PATIENT = [
    "safety.timing.command=0.5",
    "safety.timing.controller=5.0",
    "safety.timing.angle=5.0",
    "safety.timing.angle_lost=6.0",
    "safety.timing.speed=5.0",
    "safety.timing.recorder=20.0",
    "safety.timing.lease=30.0",
    "safety.timing.late=2.0",
    "safety.drive.operator=30.0",
    "safety.drive.overruns=1000",
    "safety.engage.quiet=0.1",
    "safety.engage.seen=5.0",
    "safety.engage.fixed=2.0",
]
