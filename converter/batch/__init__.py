"""Many pictures, drawn in this process or by others, and kept so that nothing is drawn twice."""
