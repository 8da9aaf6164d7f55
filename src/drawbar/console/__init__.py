"""Console: the operator's pages in a browser; its own process, which may die without consequence (docs/console.md)."""
