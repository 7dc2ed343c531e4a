"""What a key may hold, declared once: the layer under measurement.yaml and under the configuration, on pydantic."""
