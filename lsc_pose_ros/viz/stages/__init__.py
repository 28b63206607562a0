"""One body through every stage of the method, a picture each."""
