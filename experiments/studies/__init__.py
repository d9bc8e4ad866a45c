"""Ready studies, one TOML file each; ``python -m experiments.studies`` runs them for every tool."""
