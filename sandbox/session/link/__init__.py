"""Links: a run in the fragment of an address."""
