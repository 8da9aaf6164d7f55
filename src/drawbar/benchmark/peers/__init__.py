"""Peers: HPIPM, DAQP and PIQP on the stage problems of a run, each at its best settings, their answers checked."""
