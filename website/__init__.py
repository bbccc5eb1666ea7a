"""The documentation as a site: which pages there are, and what is made from the program."""
