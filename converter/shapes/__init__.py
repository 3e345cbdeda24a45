"""What is to be known of each kind of shape: a module a kind, all with the functions of `kind.ShapeKind`."""
