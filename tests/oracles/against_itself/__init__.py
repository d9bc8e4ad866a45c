"""What tests and benchmarks share: the program compared with itself where it must not differ."""
