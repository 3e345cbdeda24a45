"""What is to be known of each kind of pigment: a module a kind, all with the functions of `kind.PigmentKind`."""
