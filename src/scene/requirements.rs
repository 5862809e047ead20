//! Which features of the model a scene needs, and why.
