"""Pictures and reports drawn from arrays; imports core only."""
