"""The method of the paper on plain arrays: from a depth image and a mask to joints."""
