"""Export of a configuration as a stand-alone C library: sources, headers, example, built targets, manifest."""
