"""The first loss of stability: the search for it, maps of it, its boundaries, and its error against the beam itself."""
