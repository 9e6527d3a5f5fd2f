"""Violent and long figures, run by hand; samples of them are in the tests."""
