"""drawbar's control step on a machine of one's own; docs/own-machine.md explains it.

A few lines of kinematics stand for the machine: a CAN bus, a ROS node or another simulator takes their place.
Run: python examples/own_machine.py [FOLDER]
"""

import sys
from cmath import rect
from contextlib import closing
from math import cos, sin, tan
from pathlib import Path as FilePath

import numpy as np

import drawbar
from drawbar import Command, FixQuality, Measurement

CONFIGURATION = drawbar.load_configuration(
    "articulated", ["name=own-machine", "speed=1.5", "path.radii=[7.0]", "path.straight_length=4.0"]
)
VEHICLE, PERIOD, STEPS = CONFIGURATION.vehicle, CONFIGURATION.sample_time, 20  # PERIOD in s; STEPS of the world in it
NOISE, LAGS = 0.02, (VEHICLE.steering_lag, VEHICLE.steering_lag, 0.5)  # of a position, m; of the actuators, s


class OwnMachine(drawbar.Machine):
    """Tractor and trailer that roll where their wheels point, two RTK receivers, four sensors, a clock of its own."""

    def __init__(self, seed: int = 0) -> None:
        """Stand where the path begins, the trailer straight behind; the clock may begin anywhere."""
        self.clock, self.random = 7000.0, np.random.default_rng(seed)
        self.state, self.wanted = np.zeros(7), np.zeros(3)  # x, y, yaw, trailer's yaw, front wheels, joint, speed

    def read(self) -> Measurement:
        """Wait for the next sample: here the world rolls on; a real machine waits for its receivers."""
        for _ in range(STEPS):
            self.roll(PERIOD / STEPS)
        self.clock += PERIOD
        x, y, yaw, trailer_yaw, front, joint, speed = self.state
        hitch = complex(x, y) - rect(VEHICLE.free_joint_offset, yaw)
        joint_place = hitch - rect(VEHICLE.drawbar_length, trailer_yaw + joint)
        trailer = joint_place - rect(VEHICLE.trailer_length - VEHICLE.trailer_antenna, trailer_yaw)
        noise = self.random.normal(0.0, NOISE, 4)
        return Measurement(
            time=self.clock,
            tractor_x=x + noise[0],
            tractor_y=y + noise[1],
            trailer_x=trailer.real + noise[2],
            trailer_y=trailer.imag + noise[3],
            hitch_angle=yaw - trailer_yaw - joint,
            speed=speed,
            tractor_steering=front,
            trailer_steering=joint,
            tractor_fix_quality=FixQuality.FIXED,
            trailer_fix_quality=FixQuality.FIXED,
        )

    def write(self, command: Command) -> None:
        """Hand the command to the actuators, and return at once."""
        self.wanted[:] = command.tractor_steering, command.trailer_steering, command.speed

    def stop(self) -> None:
        """Stop with the steering held: the last thing that the machine is told, whatever ends the drive."""
        self.wanted[:] = *self.state[4:6], 0.0

    def roll(self, step: float) -> None:
        """Move for a step, s: no axle slips sideways."""
        _, _, yaw, trailer_yaw, front, joint, speed = self.state
        rates = (self.wanted - self.state[4:]) / LAGS
        hitch, swing = yaw - trailer_yaw, VEHICLE.drawbar_length * cos(joint)
        yaw_rate = speed * tan(front) / VEHICLE.wheelbase
        across = speed * sin(hitch) - VEHICLE.free_joint_offset * yaw_rate * cos(hitch) - swing * rates[1]
        trailer_rate = across / (VEHICLE.trailer_length + swing)
        self.state += step * np.array([speed * cos(yaw), speed * sin(yaw), yaw_rate, trailer_rate, *rates])


def main(folder: FilePath) -> None:
    """Drive the configured path; leave log.mcap and report.html in the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path, drivable = drawbar.build_path(CONFIGURATION)
    autopilot = drawbar.build_autopilot(CONFIGURATION)
    autopilot.begin(path)
    log = drawbar.Recorder(folder / "log.mcap", drawbar.run_header(CONFIGURATION, path, drivable))
    with log, closing(drawbar.drive(OwnMachine(), autopilot, time_limit=120.0)) as steps:
        for record in steps:
            log.write(record)
            if record.step % 50 == 0:
                places = record.reference.tractor, record.reference.trailer
                tractor, trailer = (100.0 * place.lateral_error for place in places)
                print(f"{record.step * PERIOD:4.0f} s: tractor {tractor:4.1f} cm, trailer {trailer:4.1f} cm")
    print(f"{drawbar.write_report(folder).outcome}; {folder / 'report.html'}")


if __name__ == "__main__":
    main(FilePath(sys.argv[1] if len(sys.argv) > 1 else "runs/own-machine"))
