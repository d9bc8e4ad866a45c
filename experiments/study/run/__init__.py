"""Run a study: shards, folders, threads or a cluster, one trial again."""
