"""How long tests wait."""

#: The longest wait for an event, seconds. Only a broken program needs more: the first pictures compile shaders.
PATIENCE = 240.0
