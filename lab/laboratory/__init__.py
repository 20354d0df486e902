"""The laboratory: drives and matrices of them, replayed by the programs of cartvo and judged by the truth."""
