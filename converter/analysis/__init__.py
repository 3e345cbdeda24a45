"""What is found out about a whole scene: what is one plane, what a cut-off costs, what is odd, where methods fail."""
