"""Fields: boundary and lines as they lie on Earth, new lines beside them, and the formats of other programs."""
