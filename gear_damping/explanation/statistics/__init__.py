"""Statistics of an explanation: arrays in, numbers out; nothing here knows a record or a model."""
