"""Both renderers behind one interface."""
