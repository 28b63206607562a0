"""The paper's tables and figures, measured on recordings of one's own."""
