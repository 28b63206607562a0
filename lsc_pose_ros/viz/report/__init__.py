"""The contact sheet of a recording, and the figures and the page of an evaluation."""
