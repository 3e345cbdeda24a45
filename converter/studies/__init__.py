"""Studies of the methods: how long each takes for how large an error."""
