"""What a stranger tries first: README's first command in a fresh clone, and the wheel on every Python there is."""
