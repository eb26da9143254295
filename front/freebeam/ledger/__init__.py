"""The ledger of the paper: every numbered equation, number and claim, with what the program makes of it."""
