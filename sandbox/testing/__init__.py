"""For tests of levels and recordings: a plugin of pytest, loaded wherever the package is installed."""
