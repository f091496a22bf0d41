"""What the verbs of the command line print: a verb loads the module that it needs, and no other."""
