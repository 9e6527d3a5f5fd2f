"""What leaves the sandbox: a body's springs in the terms of other engines, and levels as flat data and pictures."""
