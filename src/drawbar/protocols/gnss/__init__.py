"""GNSS receivers: bytes of NMEA, SBF, UBX and RTCM into epochs in SI."""
