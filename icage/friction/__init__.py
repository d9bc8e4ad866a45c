"""What friction leaves of the guaranteed set: where a closing hand can jam, and how soon."""
