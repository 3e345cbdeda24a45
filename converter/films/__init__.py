"""Films: scenes whose numbers change with time, by keyframes."""
