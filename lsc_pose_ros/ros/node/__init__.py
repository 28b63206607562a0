"""The live node: states, parameters, and the pipeline while it is active."""
