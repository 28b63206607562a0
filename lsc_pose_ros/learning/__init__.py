"""Growing trees, fitting leaves, evaluating; imports core only."""
