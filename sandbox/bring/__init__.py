"""Makes levels of drawings, pictures, maps and scenes that other programs have written."""
