"""Live graphs of a run: what is measured, kept for a while, and drawn under the world."""
