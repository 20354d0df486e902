"""`cartvo evaluate`: compares trajectories and messages of cartvod with the truth."""
