"""The physics: everything that needs MuJoCo, nothing that plots."""
