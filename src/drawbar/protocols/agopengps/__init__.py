"""AgOpenGPS: its frames over UDP, and a steering actuator behind an AIO board. Pure, without numpy."""
