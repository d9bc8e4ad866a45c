"""Ready studies, a TOML file each; ``python -m experiments.study.ready`` runs all of them."""
