"""SDF: read worlds and models, their includes, frames and shapes."""
