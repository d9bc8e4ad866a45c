"""``icage shake``: after closing, is the object held?"""
