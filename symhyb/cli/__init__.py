"""The command line: one file for each verb, or for verbs of one kind."""
