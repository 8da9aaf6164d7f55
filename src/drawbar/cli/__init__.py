"""The command line, a file for each command. Heavy modules are imported within the commands, so that help is quick."""
