"""Ready studies, one TOML file each; ``python -m experiments.study.ready`` runs them for every tool."""
