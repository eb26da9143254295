"""One file a column: its energies, virtual work, ends and parameters."""
