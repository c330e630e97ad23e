"""The messages of the protocol. Their module is generated from surfcast.proto."""
