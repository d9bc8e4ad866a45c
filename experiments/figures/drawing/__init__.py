"""What figures and videos share: colours, shapes, labels, a fast canvas."""
