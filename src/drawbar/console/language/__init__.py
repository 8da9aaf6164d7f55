"""Language: what the console says, in English and German."""
