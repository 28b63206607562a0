"""Pictures and reports drawn from arrays; imports core and learning only."""
