"""The paper's numbered equations: as printed, as read, and as derived."""
