"""Rules: what a level asks at the end of each tick, and what it does when that holds."""
