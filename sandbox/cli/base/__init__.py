"""What the files of commands share: typed options, what is read, what is written."""
