"""The kinds of shapes, a module each, and the table of them."""
