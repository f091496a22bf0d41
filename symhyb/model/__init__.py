"""What a person declares: types, vocabulary, expressions, and the model file read and written."""
