"""The card of how a thing feels: measured beside the run, sought for, and taken home."""
