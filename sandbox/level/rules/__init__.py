"""Rules of a level: counters, what is asked at the end of each tick, and what is done when that holds."""
