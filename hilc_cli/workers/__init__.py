"""Work in pieces, handed out to this process, to others on this machine, or to a cluster."""
